// SPDX-License-Identifier: Apache-2.0
// Distribution of an overlapping estimate under noise of given terms.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/power_law.h"
#include "filters/allan/weighted_chi_squared.h"

namespace ifog {

// Distribution of estimate / mean as a weighted sum of χ². degrees: equivalent degrees of freedom
// (EstimateVariance). If it is large, one χ². Else the weights are eigenvalues of the covariance of
// differences m/8 apart, plus one part for quantisation. samples: lengths of the stretches. Empty if no
// difference fits.
[[nodiscard]] std::vector<WeightedChiSquared> estimate_law(Deviation kind, std::size_t m,
                                                           std::span<const std::size_t> samples,
                                                           const TermVariances& variances, double degrees);

}  // namespace ifog
