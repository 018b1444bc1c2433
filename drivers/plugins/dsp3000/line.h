// SPDX-License-Identifier: Apache-2.0
// One line of a KVH DSP-3000 with the digital 100 Hz interface. Source: DSP-3000 technical manual 54-0215,
// section 2.1.
//
//   (-)xxx.xxxxxx y CR LF      y is 1 for valid data, 0 for a fault
//
// There is no checksum or counter, so a lost or changed digit is undetectable. Only the form is checked
// (exactly six decimals), which detects most errors of a bad line. Any line end is accepted, for logs.
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

inline constexpr std::size_t kLongestLine = 32;  // including leading blanks, without the line end
inline constexpr std::int32_t kHighest = 999'999'999;

// line: without CR and LF. nullopt for another form. Surrounding blanks are ignored.
std::optional<Reading> parse_line(std::string_view line) noexcept;

// Writes the line with CR LF into at least kLongestLine bytes; returns the length. |micro_degrees| <=
// kHighest.
std::size_t format_line(const Reading& reading, char* out) noexcept;

}  // namespace ifog::dsp3000
