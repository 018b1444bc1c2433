// SPDX-License-Identifier: Apache-2.0
// Resonances and lines in the noise as damped harmonics. Their number minimises the Bayesian information
// criterion. Each is searched where the innovations are not white and is fitted jointly with white noise,
// flicker and walk.
#pragma once

#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Limits of harmonics on this grid.
struct HarmonicLimits {
  double least_cycles = 0.0;                   // per block; a slower one could be mistaken for an effect
  double least_decay = 0.0, most_decay = 0.0;  // in blocks; one with a longer decay is a line
};
HarmonicLimits harmonic_limits(const BlockGrid& grid);

// `fit`, which has none, with harmonics, all refitted. columns: measurement, then regressors, not whitened.
NoiseFit with_harmonics(const BlockGrid& grid, const Columns& columns, const NoiseFit& fit);

}  // namespace ifog
