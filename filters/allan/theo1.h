// SPDX-License-Identifier: Apache-2.0
// Thêo1: a variance that looks up to three quarters of a record ahead, where the Allan variance ends at half
// of it with a single difference (Howe and Peppler, "Very long-term frequency stability", IEEE Int. Frequency
// Control Symposium 2003; NIST SP 1065, section 5.2.18). It is biased for everything but white rate noise;
// what its mean and its scatter are under the noise found in the record is computed from the quadratic form
// itself, so the bias is removed and the interval holds for any mixture of terms.
#pragma once

#include <vector>

#include "filters/allan/confidence.h"

namespace ifog {

struct LongPoint {
  double tau = 0.0;       // in samples: 0.75 of the span
  double variance = 0.0;  // an estimate of the Allan variance there, bias removed; (rad/s)²
  double bias = 1.0;      // Allan over Thêo1 in the mean, under these terms; already in `variance`
  AllanInterval interval;
};

// Theo1 of the longest stretch, for τ beyond the longest a trusted Allan variance has (a quarter of it) up to 0.75
// of it, `per_decade` to a factor of ten; at least one. The angle is sampled at some 128 places, which such
// long averages do not notice. terms as for allan_intervals. Empty for stretches of fewer than 64 samples.
[[nodiscard]] std::vector<LongPoint> theo1(const AngleSum& sum, const TermVariances& terms, double confidence,
                                           int per_decade);

// The plain Thêo1 variance of angles one sample apart at an even span m, in (rad/s)²: the definition.
[[nodiscard]] double theo1_variance(std::span<const double> angle, std::size_t m);

}  // namespace ifog
