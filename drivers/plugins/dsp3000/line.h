// SPDX-License-Identifier: Apache-2.0
// One line of a KVH DSP-3000 with the digital 100 Hz interface. Source: DSP-3000 technical manual 54-0215,
// section 2.1.
//
//   (-)xxx.xxxxxx y CR LF      y is 1 for valid data, 0 for a fault
//
// There is no checksum or counter, so a lost or changed digit is undetectable. Only the form is checked
// (exactly six decimals), which detects most errors of a bad line. Any line end is accepted, for logs.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>
#include <span>
#include <string_view>
#include <utility>

#include "ifog/driver.h"

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

// Splits a byte stream into lines.
class LineFinder {
 public:
  // Calls found(Reading) for each valid line, in order. No allocation. A line ends with any sequence of CR
  // and LF, or with its datagram.
  template <typename Found>
  void feed(std::span<const std::uint8_t> bytes, Found&& found) noexcept {
    if (bytes.empty()) return;
    // A complete line without an end: each line is in its own datagram.
    if (length_ > 0 && !ends(static_cast<char>(bytes.front())) && parse_line({line_.data(), length_})) {
      datagrams_ = true;
      if (const std::optional<Reading> reading = end(0)) found(*reading);
    }
    for (const std::uint8_t byte : bytes)
      if (const std::optional<Reading> reading = take(static_cast<char>(byte))) found(*reading);
    if (datagrams_ && length_ > 0 && parse_line({line_.data(), length_}))
      if (const std::optional<Reading> reading = end(0)) found(*reading);
  }

  // The next line is ignored until a line end, because the tail of a number is a number too.
  void reset() noexcept {
    counters_.bytes_skipped += length_;
    length_ = 0;
    in_step_ = false;
  }

  // frames_format: lines of another form; bytes_framed: of valid lines and line ends.
  [[nodiscard]] ifog_driver_counters counters() const {
    ifog_driver_counters out = counters_;
    out.bytes_pending = length_;
    return out;
  }

 private:
  std::optional<Reading> take(char c) noexcept {
    if (length_ == line_.size()) {  // too long; ignored until the next line end
      counters_.bytes_skipped += length_;
      length_ = 0;
      in_step_ = false;
    }
    if (ends(c)) return end(1);
    line_[length_++] = c;
    return {};
  }

  [[nodiscard]] static bool ends(char c) noexcept { return c == '\r' || c == '\n'; }
  // ending: bytes of the line end.
  std::optional<Reading> end(std::size_t ending) noexcept {
    const std::string_view line(line_.data(), std::exchange(length_, 0));
    const bool whole = std::exchange(in_step_, true);
    if (line.empty()) {
      counters_.bytes_framed += ending;
      return {};
    }
    const std::optional<Reading> reading = whole ? parse_line(line) : std::nullopt;
    (reading ? counters_.bytes_framed : counters_.bytes_skipped) += line.size() + ending;
    if (reading)
      ++counters_.frames_good;
    else if (whole)  // text before the first line end is no fault
      ++counters_.frames_format;
    return reading;
  }

  std::array<char, kLongestLine> line_{};
  std::size_t length_ = 0;
  bool in_step_ = false;
  bool datagrams_ = false;
  ifog_driver_counters counters_{};
};

}  // namespace ifog::dsp3000
