// SPDX-License-Identifier: Apache-2.0
// Distribution of an overlapping estimate about its mean, under noise of given terms.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/power_law.h"
#include "filters/allan/weighted_chi_squared.h"

namespace ifog {

// Distribution of estimate over mean. `degrees` is what EstimateVariance says of the same; where it is small the weights
// are the eigenvalues of the differences' covariance, at places an eighth of m apart: the slow terms
// change little between them, and what quantisation adds, independent from place to place, is one more part.
// One part where it is large. samples: lengths of the stretches. Empty where no difference fits.
[[nodiscard]] std::vector<WeightedChiSquared> estimate_law(Deviation kind, std::size_t m,
                                                           std::span<const std::size_t> samples,
                                                           const TermVariances& variances, double degrees);

}  // namespace ifog
