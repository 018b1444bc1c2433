// SPDX-License-Identifier: Apache-2.0
// What is usual among many values.
#pragma once

#include <algorithm>
#include <iterator>
#include <vector>

namespace ifog {

// The upper one of two in the middle. At least one value, none of them NaN.
[[nodiscard]] inline double median(std::vector<double> values) {
  const auto middle = values.begin() + std::ssize(values) / 2;
  std::nth_element(values.begin(), middle, values.end());
  return *middle;
}

}  // namespace ifog
