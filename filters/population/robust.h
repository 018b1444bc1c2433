// SPDX-License-Identifier: Apache-2.0
// Who stands out of a population, by measures that those who do cannot move.
#pragma once

#include <span>
#include <vector>

namespace ifog {

// Beyond this a member stands out (Iglewicz and Hoaglin, How to Detect and Handle Outliers, 1993).
inline constexpr double kStandsOut = 3.5;

struct RobustSpread {
  double median = 0.0;
  double sigma = 0.0;  // 1.4826 times the median distance from it: a normal distribution's deviation
};

// NaNs are ignored. Nothing finite: zeros.
RobustSpread robust_spread(std::span<const double> values);

// Distance from the median over what a member's distance may be: the population's sigma, and where its own
// error of measurement (`errors`, as many, or none) is larger than a typical one, that in a typical one's
// place. NaN where the value is none; zero everywhere when more than half of the values are the same.
std::vector<double> robust_z(std::span<const double> values, std::span<const double> errors = {});

}  // namespace ifog
