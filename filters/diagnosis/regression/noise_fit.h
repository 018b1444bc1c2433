// SPDX-License-Identifier: Apache-2.0
// Maximum likelihood of the noise model, given regressors. The white variance and the regressors'
// coefficients are concentrated out of the innovations' likelihood.
#pragma once

#include "filters/diagnosis/regression/whitening.h"

namespace ifog {

// Residual of the first whitened column after least squares on the others.
struct WhitenedFit {
  double log_likelihood = 0.0;  // except for a constant that depends only on the number of blocks
  double white_variance = 0.0;  // of a block mean, in the first column's unit squared
};

// columns: measurement, then regressors, not whitened.
WhitenedFit fit_whitened(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns);

struct NoiseFit {
  NoiseShape shape;
  double log_likelihood = 0.0;
  double white_variance = 0.0;
};

// Fits walk and flicker, both may become zero, starting at `start`. Keeps the harmonics of `start`.
NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns, const NoiseShape& start,
                   double precision = 1.05);

// Fits from a coarse grid, then the number of harmonics.
NoiseFit fit_noise(const BlockGrid& grid, const Columns& columns);

// Local maximum of the likelihood, starting at `shape`: walk and flicker, if not zero, and the harmonics if
// `with_harmonics`.
NoiseFit climb(const BlockGrid& grid, const Columns& columns, NoiseShape shape, double precision,
               bool with_harmonics = false);

}  // namespace ifog
