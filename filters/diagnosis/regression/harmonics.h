// SPDX-License-Identifier: Apache-2.0
// Resonances and lines in the noise: damped harmonics, as many as the Bayesian information criterion asks
// for, each sought where the innovations of the noise so far are not white, and fitted together with white
// noise, flicker and walk by the likelihood of the innovations.
#pragma once

#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Limits of what may be called a harmonic on this grid.
struct HarmonicLimits {
  double least_cycles = 0.0;                   // a block: slower ones an effect may be mistaken for
  double least_decay = 0.0, most_decay = 0.0;  // blocks: what keeps its phase longer is a line
};
HarmonicLimits harmonic_limits(const BlockGrid& grid);

// Less is better. Counts the noise parameters besides white noise, flicker and walk, without constants.
double information_criterion(const BlockGrid& grid, const NoiseFit& fit);

// `fit` with harmonics added, those it has kept where they are still worth their parameters, all refitted;
// as it was when it has none and none is there. columns: measurement, then regressors, not whitened.
NoiseFit with_harmonics(const BlockGrid& grid, const Columns& columns, const NoiseFit& fit);

}  // namespace ifog
