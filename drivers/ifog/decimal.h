// SPDX-License-Identifier: Apache-2.0
// A number in a text from outside: in digits with a point, no locale. The one home of the rule, header only,
// so that a plugin built out of tree reads numbers as the programs here do.
#pragma once

#include <algorithm>
#include <charconv>
#include <system_error>

namespace ifog {

namespace decimal {

// Of a number in digits that no double holds: too small, not too large. By the place of its first digit that
// is not 0.
inline bool too_small(const char* at, const char* end) noexcept {
  constexpr long kFar = 1'000'000'000;
  long place = 0, exponent = 0;
  bool significant = false, fraction = false;
  for (; at != end && *at != 'e' && *at != 'E'; ++at) {
    if (*at == '.') {
      fraction = true;
    } else if (*at >= '0' && *at <= '9') {
      significant = significant || *at != '0';
      if (fraction && !significant) --place;
      if (!fraction && significant) ++place;
    }
  }
  if (at != end && ++at != end && *at == '+') ++at;
  const bool down = at != end && *at == '-';
  if (std::from_chars(at, end, exponent).ec == std::errc::result_out_of_range) exponent = down ? -kFar : kFar;
  return std::clamp(exponent, -kFar, kFar) + place < 0;
}

}  // namespace decimal

// As std::from_chars, but a plus sign may lead, and what is too small for a double is 0: a measurement so
// near to zero is good, and no less so for the digits it was written with.
inline std::from_chars_result read_decimal(const char* begin, const char* end, double& value) noexcept {
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  std::from_chars_result read = std::from_chars(begin, end, value);
  if (read.ec == std::errc::result_out_of_range && decimal::too_small(begin, read.ptr)) {
    value = *begin == '-' ? -0.0 : 0.0;
    read.ec = std::errc();
  }
  return read;
}

}  // namespace ifog
