// SPDX-License-Identifier: Apache-2.0
// What people call the axes of a message, which carries no names.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace ifog {

// x, y, z; of a single axis, which may lie anywhere, "rate".
constexpr std::string_view axis_name(std::size_t axis, std::size_t axes) {
  constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
  return axes == 1 ? "rate" : axis < kNames.size() ? kNames[axis] : "?";
}

}  // namespace ifog
