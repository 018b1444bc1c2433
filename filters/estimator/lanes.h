// SPDX-License-Identifier: Apache-2.0
// One number of each axis side by side, so that a step of all axes is one of vector registers.
#pragma once

#include <Eigen/Core>
#include <cstddef>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

// The last has no axis.
using Lanes = Eigen::Array<double, 4, 1>;
static_assert(kMaxAxes < Lanes::SizeAtCompileTime);

// Sum over the axes, in their order.
[[nodiscard]] inline double sum_of_axes(const Lanes& lanes) noexcept {
  return 0.0 + lanes[0] + lanes[1] + lanes[2];
}

// The axes that a sensor of so many has, bit i.
[[nodiscard]] constexpr std::uint32_t axes_of_sensor(std::size_t axes) noexcept { return (1U << axes) - 1U; }

}  // namespace ifog
