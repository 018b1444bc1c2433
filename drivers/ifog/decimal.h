// SPDX-License-Identifier: Apache-2.0
// Parses a decimal number with a point, independent of the locale. Header only, so that out-of-tree plugins
// parse numbers in the same way.
#pragma once

#include <charconv>
#include <cmath>
#include <string_view>
#include <system_error>

namespace ifog {

namespace decimal {

// True if a number outside the range of double is too small, not too large.
inline bool too_small(std::string_view digits) noexcept {
  long double wide = 0.0L;
  const bool holds = std::from_chars(digits.data(), digits.data() + digits.size(), wide).ec == std::errc();
  if (holds) return std::abs(wide) < 1.0L;
  const std::size_t exponent = digits.find_first_of("eE");
  return exponent != std::string_view::npos && digits.substr(exponent + 1).starts_with('-');
}

}  // namespace decimal

// As std::from_chars, but accepts a leading plus sign and rounds too small numbers to 0.
inline std::from_chars_result read_decimal(const char* begin, const char* end, double& value) noexcept {
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  std::from_chars_result read = std::from_chars(begin, end, value);
  if (read.ec == std::errc::result_out_of_range && decimal::too_small({begin, read.ptr})) {
    value = *begin == '-' ? -0.0 : 0.0;
    read.ec = std::errc();
  }
  return read;
}

}  // namespace ifog
