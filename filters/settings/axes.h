// SPDX-License-Identifier: Apache-2.0
// Largest number of axes of a sensor, and an array of one value per axis.
#pragma once

#include <array>

namespace ifog {

inline constexpr int kMaxAxes = 3;

using Axes = std::array<double, kMaxAxes>;

}  // namespace ifog
