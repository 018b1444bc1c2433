// SPDX-License-Identifier: Apache-2.0
// Thêo1 variance: reaches three quarters of a record, where the Allan variance ends at half with a single
// difference (Howe and Peppler, IEEE Int. Frequency Control Symposium 2003; NIST SP 1065, section 5.2.18). It
// is biased except for white rate noise. Its mean and scatter under the record's noise are computed from the
// quadratic form, so the bias is removed and the interval holds for any mixture of terms.
#pragma once

#include <vector>

#include "filters/allan/confidence.h"

namespace ifog {

struct LongPoint {
  double tau = 0.0;       // in samples: 0.75 of the span
  double variance = 0.0;  // estimate of the Allan variance, bias removed; (rad/s)²
  double bias = 1.0;      // expected Allan / expected Thêo1 under these terms; already applied to `variance`
  AllanInterval interval;
};

// Thêo1 of the longest stretch for τ from a quarter of its length (the longest trusted Allan variance) to
// 0.75 of it; `per_decade` points, at least one. The angle is decimated to about 128 places. terms: as for
// allan_intervals. Empty for stretches below 64 samples.
[[nodiscard]] std::vector<LongPoint> theo1(const AngleSum& sum, const TermVariances& terms, double confidence,
                                           int per_decade);

}  // namespace ifog
