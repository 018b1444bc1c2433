// SPDX-License-Identifier: Apache-2.0
// Distribution of a quadratic form of Gaussian variables: a sum of independent χ² variables, each with a
// weight of its own. The overlapping variances are such sums; where few averages fit into the record, a
// single χ² with their mean and variance has too heavy a tail near zero, and its 68 % interval would hold in
// 73 to 80 %.
#pragma once

#include <span>

namespace ifog {

struct WeightedChiSquared {
  double weight = 0.0;   // > 0
  double degrees = 0.0;  // > 0, need not be whole
};

// Value below which the sum stays with probability p. One part: exact. Several: saddlepoint approximation
// (Lugannani and Rice, Adv. Appl. Prob. 12, 1980; for quadratic forms Kuonen, Biometrika 86, 1999), the
// probability good to two per cent of itself.
[[nodiscard]] double quantile(std::span<const WeightedChiSquared> parts, double p);

// Equivalent degrees of freedom, 2·mean²/variance.
[[nodiscard]] double equivalent_degrees(std::span<const WeightedChiSquared> parts);

}  // namespace ifog
