// SPDX-License-Identifier: Apache-2.0
// One line of a KVH DSP-3000 with the digital 100 Hz interface. Source: DSP-3000 technical manual 54-0215,
// section 2.1.
//
//   (-)xxx.xxxxxx y CR LF      y is 1 for valid data, 0 for a fault
//
// There is no checksum and no counter: a lost or changed digit is a wrong value that nothing can tell. What
// can be held to is the form, six decimals exactly, which catches most of what a bad line does. Loggers write
// other line ends: any is accepted.
#pragma once

#include <cstddef>
#include <cstdint>
#include <optional>
#include <string_view>

namespace ifog::dsp3000 {

struct Reading {
  std::int32_t micro_degrees = 0;  // µdeg or µdeg/s
  bool valid = false;
};

inline constexpr std::size_t kLongestLine = 32;  // with some blanks in front; the line end not counted
inline constexpr std::int32_t kHighest = 999'999'999;

// `line` without CR and LF. Nothing if it has not the form above. Blanks around the two words are passed
// over.
std::optional<Reading> parse_line(std::string_view line) noexcept;

// Writes the line with its CR LF into at least kLongestLine bytes; returns the length. |micro_degrees| <=
// kHighest.
std::size_t format_line(const Reading& reading, char* out) noexcept;

}  // namespace ifog::dsp3000
