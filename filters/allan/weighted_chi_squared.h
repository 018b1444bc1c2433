// SPDX-License-Identifier: Apache-2.0
// Distribution of a quadratic form of Gaussian variables: a weighted sum of independent χ². Overlapping
// variances are such sums. With few averages a single χ² of the same mean and variance has too heavy a tail
// near zero: its 68 % interval would hold in 73 to 80 %.
#pragma once

#include <span>

namespace ifog {

struct WeightedChiSquared {
  double weight = 0.0;   // > 0
  double degrees = 0.0;  // > 0, need not be whole
};

// Quantile of the sum at probability p. One part: exact. Several: saddlepoint approximation (Lugannani and
// Rice, Adv. Appl. Prob. 12, 1980; for quadratic forms Kuonen, Biometrika 86, 1999), whose probability is
// accurate to 2 %.
[[nodiscard]] double quantile(std::span<const WeightedChiSquared> parts, double p);

// Equivalent degrees of freedom, 2·mean²/variance.
[[nodiscard]] double equivalent_degrees(std::span<const WeightedChiSquared> parts);

}  // namespace ifog
