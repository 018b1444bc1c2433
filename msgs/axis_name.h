// SPDX-License-Identifier: Apache-2.0
// Names of a message's axes; messages contain none.
#pragma once

#include <array>
#include <cstddef>
#include <string_view>

namespace ifog {

// x, y, z; "rate" for a single axis, whose direction is unknown.
constexpr std::string_view axis_name(std::size_t axis, std::size_t axes) {
  constexpr std::array<std::string_view, 3> kNames{"x", "y", "z"};
  return axes == 1 ? "rate" : axis < kNames.size() ? kNames[axis] : "?";
}

}  // namespace ifog
