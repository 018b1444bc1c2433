// SPDX-License-Identifier: Apache-2.0
// How many axes a sensor has at most, and a figure for each of them.
#pragma once

#include <array>

namespace ifog {

inline constexpr int kMaxAxes = 3;

using Axes = std::array<double, kMaxAxes>;

}  // namespace ifog
