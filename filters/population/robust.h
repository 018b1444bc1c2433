// SPDX-License-Identifier: Apache-2.0
// Robust detection of outliers in a population.
#pragma once

#include <span>
#include <vector>

namespace ifog {

// Limit of robust z (Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993).
inline constexpr double kStandsOut = 3.5;

struct RobustSpread {
  double median = 0.0;
  double sigma = 0.0;  // 1.4826 times the median absolute deviation
};

// NaNs are ignored; zeros if nothing is finite.
RobustSpread robust_spread(std::span<const double> values);

// Distance from the median / its expected size: the population's sigma, increased if the member's measurement
// error (`errors`, as many, or none) is above the median one. NaN for NaN; all zero if more than half of the
// values are equal.
std::vector<double> robust_z(std::span<const double> values, std::span<const double> errors = {});

}  // namespace ifog
