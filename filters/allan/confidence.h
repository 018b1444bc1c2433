// SPDX-License-Identifier: Apache-2.0
// Confidence intervals of measured variances, from the distribution of the estimator under the noise of the
// record (estimate_law.h). The noise is fitted to the whole record, not to the few averages at τ, so its type
// may change along τ.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/deviation.h"
#include "filters/allan/estimate_law.h"

namespace ifog {

struct AllanInterval {
  Term strongest = kN;  // largest part of the variance at this τ
  double degrees = 0.0;
  double lower_radps = 0.0, upper_radps = 0.0;  // of the deviation; NaN if no difference fits
};

// Interval that contains the root of the true variance with probability `confidence` (0 to 1). law:
// distribution of estimate / mean.
[[nodiscard]] AllanInterval interval_of(double variance, std::span<const WeightedChiSquared> law,
                                        double confidence);

// One interval per point, for the overlapping estimator `kind` under noise of these terms. White noise is
// assumed if all terms are zero.
[[nodiscard]] std::vector<AllanInterval> allan_intervals(const AngleSum& sum, Deviation kind,
                                                         std::span<const DeviationPoint> points,
                                                         const TermVariances& terms, double confidence);

}  // namespace ifog
