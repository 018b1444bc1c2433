// SPDX-License-Identifier: Apache-2.0
// printf(3) into a string, and a capture's time with a resolution of µs.
#pragma once

#include <cmath>
#include <cstdarg>
#include <cstddef>
#include <cstdio>
#include <string>

namespace ifog {

inline std::string formatted_list(const char* format, std::va_list values) {
  std::va_list again;
  va_copy(again, values);
  const int length = std::vsnprintf(nullptr, 0, format, again);
  va_end(again);
  std::string out(length > 0 ? static_cast<std::size_t>(length) : 0, '\0');
  std::vsnprintf(out.data(), out.size() + 1, format, values);
  return out;
}

[[gnu::format(printf, 1, 2)]] inline std::string formatted(const char* format, ...) {
  std::va_list values;
  va_start(values, format);
  std::string out = formatted_list(format, values);
  va_end(values);
  return out;
}

[[nodiscard]] inline std::string told_time(double time_s) {
  const double size = std::abs(time_s);
  // Six digits below 1000 s, then six decimals.
  const int before = size < 1000.0 ? 0 : static_cast<int>(std::log10(size)) + 1;
  return formatted("%.*g", before + 6, time_s);
}

}  // namespace ifog
