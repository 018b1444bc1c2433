// SPDX-License-Identifier: Apache-2.0
// Median.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

namespace ifog {

// For an even number, the upper of the middle two. Needs at least one value, no NaN.
[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ifog
