// SPDX-License-Identifier: Apache-2.0
// Cuts a byte stream into the lines of line.h.
#pragma once

#include <array>
#include <cstdint>
#include <span>
#include <string_view>

#include "drivers/plugins/dsp3000/line.h"

namespace ifog::dsp3000 {

class LineFinder {
 public:
  struct Counters {
    std::uint64_t good = 0;
    std::uint64_t malformed = 0;      // lines that have not the form
    std::uint64_t bytes_skipped = 0;  // bytes that are part of no good line
    std::uint64_t bytes_framed = 0;   // bytes of good lines, and of a line end in front of them
  };

  // Calls found(Reading) for each good line, in order. No allocation.
  template <typename Found>
  void feed(std::span<const std::uint8_t> bytes, Found&& found) noexcept {
    for (const std::uint8_t byte : bytes)
      if (const std::optional<Reading> reading = take(static_cast<char>(byte))) found(*reading);
  }

  // The next line is not trusted until a line end has gone by: the tail of a number is a number too.
  void reset() noexcept {
    counters_.bytes_skipped += length_;
    length_ = 0;
    in_step_ = false;
  }

  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t waiting() const { return length_; }

 private:
  std::optional<Reading> take(char c) noexcept {
    if (length_ == line_.size()) {  // longer than any line: what follows is out of step too
      counters_.bytes_skipped += length_;
      length_ = 0;
      in_step_ = false;
    }
    line_[length_++] = c;
    if (c != '\n') return {};
    const std::size_t length = length_;
    const bool whole = in_step_;
    length_ = 0;
    in_step_ = true;
    if (whole && length >= 2 && line_[length - 2] == '\r') {
      if (const std::optional<Reading> reading = parse_line({line_.data(), length - 2})) {
        ++counters_.good;
        counters_.bytes_framed += length;
        return reading;
      }
    }
    // What comes before the first line end is no fault of the line's; and a line end alone, which a recording
    // begins with where its first line is to be trusted, lacks nothing.
    if (whole) ++counters_.malformed;
    const bool only_an_end = !whole && length == 2 && line_[0] == '\r';
    (only_an_end ? counters_.bytes_framed : counters_.bytes_skipped) += length;
    return {};
  }

  std::array<char, kLongestLine + 2> line_{};
  std::size_t length_ = 0;
  bool in_step_ = false;
  Counters counters_;
};

}  // namespace ifog::dsp3000
