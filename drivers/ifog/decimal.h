// SPDX-License-Identifier: Apache-2.0
// A number in a text from outside: in digits with a point, no locale. The one home of the rule, header only,
// so that a plugin built out of tree reads numbers as the programs here do.
#pragma once

#include <algorithm>
#include <array>
#include <bit>
#include <charconv>
#include <cstddef>
#include <cstdint>
#include <cstring>
#include <system_error>

namespace ifog {

namespace decimal {

// True if a number in digits that no double holds is too small rather than too large, by the place of its first digit that
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

// Whether eight characters are digits, and then what they say: all at once, each by a byte of one word
// (Lemire, "Number parsing at a gigabyte per second", 2021, section 4).
inline bool eight_digits(const char* at, std::uint64_t& whole) noexcept {
  std::uint64_t word = 0;
  std::memcpy(&word, at, sizeof word);
  if constexpr (std::endian::native == std::endian::big) word = __builtin_bswap64(word);
  constexpr std::uint64_t kHigh = 0xF0F0F0F0F0F0F0F0U, kZeros = 0x3030303030303030U;
  // A digit is 0x30 to 0x39: its high half is 3, and with 6 more still.
  if ((word & kHigh) != kZeros || ((word + 0x0606060606060606U) & kHigh) != kZeros) return false;
  word -= kZeros;
  word = word * 10 + (word >> 8U);  // pairs, in every second byte
  whole = ((word & 0x000000FF000000FFU) * 0x000F424000000064U +
           ((word >> 16U) & 0x000000FF000000FFU) * 0x0000271000000001U) >>
          32U;
  return true;
}

// Digits that make a whole number below 2^53, times or over a power of ten that a double holds exactly: the
// one rounding is that of the product, so this is the nearest double (Clinger, "How to read floating point
// numbers accurately", 1990). Nearly every number of a capture is such, and is read in a third of the time.
// null: another.
inline const char* short_number(const char* at, const char* end, double& value) noexcept {
  constexpr std::array<double, 23> kPowers = {1e0,  1e1,  1e2,  1e3,  1e4,  1e5,  1e6,  1e7,
                                              1e8,  1e9,  1e10, 1e11, 1e12, 1e13, 1e14, 1e15,
                                              1e16, 1e17, 1e18, 1e19, 1e20, 1e21, 1e22};
  constexpr std::ptrdiff_t kMostDigits = 18;  // fit 64 bits
  const bool negative = at != end && *at == '-';
  if (negative) ++at;
  const auto digit = [&](const char* c) { return c != end && static_cast<unsigned char>(*c - '0') < 10; };
  std::uint64_t whole = 0;
  const char* const first = at;
  for (; digit(at); ++at) whole = 10 * whole + static_cast<std::uint64_t>(*at - '0');
  std::ptrdiff_t digits = at - first, power = 0;
  if (at != end && *at == '.') {
    const char* const point = at++;
    if (std::uint64_t eight = 0; end - at >= 8 && eight_digits(at, eight)) {
      whole = 100'000'000 * whole + eight;
      at += 8;
    }
    for (; digit(at); ++at) whole = 10 * whole + static_cast<std::uint64_t>(*at - '0');
    power = point + 1 - at;
    digits -= power;
  }
  if (digits == 0 || digits > kMostDigits || whole >= std::uint64_t{1} << 53U) return nullptr;
  if (at != end && (*at == 'e' || *at == 'E')) {
    ++at;
    const bool down = at != end && *at == '-';
    if (at != end && (*at == '-' || *at == '+')) ++at;
    if (!digit(at)) return nullptr;
    std::ptrdiff_t exponent = 0;
    for (; digit(at); ++at) {
      exponent = 10 * exponent + (*at - '0');
      if (exponent > 1000) return nullptr;
    }
    power += down ? -exponent : exponent;
  }
  if (power < -22 || power > 22) return nullptr;
  const auto magnitude = static_cast<double>(whole);
  value = power < 0 ? magnitude / kPowers[static_cast<std::size_t>(-power)]
                    : magnitude * kPowers[static_cast<std::size_t>(power)];
  if (negative) value = -value;
  return at;
}

}  // namespace decimal

// As std::from_chars, but a plus sign may lead, and what is too small for a double is 0: a measurement so
// near to zero is good, and no less so for the digits it was written with.
inline std::from_chars_result read_decimal(const char* begin, const char* end, double& value) noexcept {
  if (end - begin > 1 && *begin == '+' && begin[1] != '-') ++begin;
  if (const char* const at = decimal::short_number(begin, end, value)) return {at, std::errc()};
  std::from_chars_result read = std::from_chars(begin, end, value);
  if (read.ec == std::errc::result_out_of_range && decimal::too_small(begin, read.ptr)) {
    value = *begin == '-' ? -0.0 : 0.0;
    read.ec = std::errc();
  }
  return read;
}

}  // namespace ifog
