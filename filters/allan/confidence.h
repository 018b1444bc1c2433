// SPDX-License-Identifier: Apache-2.0
// How far a measured variance may be from the truth: the law that the estimator has under the noise found in
// the record (estimate_law.h), where many averages fit χ² with equivalent degrees of freedom. The noise comes
// from the fit of the whole record, not from the few averages at the τ in question, so it may change its type
// along τ, up to the longest.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/deviation.h"
#include "filters/allan/estimate_law.h"

namespace ifog {

struct AllanInterval {
  Term strongest = kN;  // the term with the largest part of the variance there
  double degrees = 0.0;
  double lower_radps = 0.0, upper_radps = 0.0;  // of the deviation; NaN where no difference fits
};

// Holds the true variance's root with probability `confidence` (0 to 1). law: of estimate over mean.
[[nodiscard]] AllanInterval interval_of(double variance, std::span<const WeightedChiSquared> law,
                                        double confidence);

// One per point, of the overlapping estimator `kind` under noise of these terms. Terms all zero: white noise
// is assumed.
[[nodiscard]] std::vector<AllanInterval> allan_intervals(const AngleSum& sum, Deviation kind,
                                                         std::span<const DeviationPoint> points,
                                                         const TermVariances& terms, double confidence);

}  // namespace ifog
