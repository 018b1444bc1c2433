// SPDX-License-Identifier: Apache-2.0
// A capture's time as text for users: in full, to the µs.
#pragma once

#include <array>
#include <cmath>
#include <cstdio>
#include <string>

namespace ifog {

[[nodiscard]] inline std::string told_time(double time_s) {
  const double size = std::abs(time_s);
  // Below 1000 s these are six digits in all.
  const int before = size < 1000.0 ? 0 : static_cast<int>(std::log10(size)) + 1;
  std::array<char, 40> text{};
  std::snprintf(text.data(), text.size(), "%.*g", before + 6, time_s);
  return text.data();
}

}  // namespace ifog
