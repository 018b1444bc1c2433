// SPDX-License-Identifier: Apache-2.0
// Maximum likelihood of the noise model, given regressors: the likelihood of the filter's innovations with
// the white variance and the coefficients of the regressors concentrated out.
#pragma once

#include "filters/diagnosis/regression/whitening.h"

namespace ifog {

// What is left of the first column of whitened data after least squares on the others.
struct WhitenedFit {
  double log_likelihood = 0.0;  // up to a constant that depends on the number of blocks alone
  double white_variance = 0.0;  // of a block mean, in the square of the first column's unit
};

// columns: measurement, then regressors, not whitened.
WhitenedFit fit_whitened(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns);

struct NoiseFit {
  NoiseShape shape;
  double log_likelihood = 0.0;
  double white_variance = 0.0;
};

// Searches walk and flicker, both down to zero, from there. Harmonics are kept as they are in `start`.
NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns, const NoiseShape& start,
                   double precision = 1.05);

// From nothing known: coarse grid, then fit_noise; then how many harmonics.
NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns);

// The way up the likelihood of the noise's parameters.
// Climbs from `shape` to the nearest top: walk and flicker where they are not zero, and down to zero; the
// harmonics when `with_harmonics`.
NoiseFit climb(const BlockGrid& grid, const Columns& columns, NoiseShape shape, double precision,
               bool with_harmonics = false);

}  // namespace ifog
