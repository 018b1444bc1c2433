// SPDX-License-Identifier: Apache-2.0
// Parses rows of a CSV capture from bytes in any portions: `#` lines, a header that starts with time_s, rows.
// No allocation after construction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

#include "drivers/ifog/driver.h"

namespace ifog::capture_rows {

constexpr std::size_t kMostColumns = 256;    // per capture
constexpr std::size_t kLongestLine = 16384;  // in bytes

class Rows {
 public:
  explicit Rows(std::vector<std::string> wanted);

  // Calls row(time_ns, values) for each complete row: the wanted columns in the wanted order, NaN if empty.
  template <typename Row>
  void feed(std::span<const std::uint8_t> bytes, Row&& row) noexcept {
    for (const std::uint8_t byte : bytes) {
      if (byte != '\n') {
        put(static_cast<char>(byte));
      } else if (end_line()) {
        row(time_ns_, std::span<const double>(values_));
      }
    }
  }
  // Another capture with its own header follows.
  void restart() noexcept;
  // frames_format: lines that are neither a header with the wanted columns nor a row; bytes_skipped: of those, of
  // too long lines, and of an incomplete last line.
  [[nodiscard]] ifog_driver_counters counters() const {
    ifog_driver_counters out = counters_;
    out.bytes_pending = waiting();
    return out;
  }

 private:
  [[nodiscard]] std::size_t waiting() const { return length_ + overlong_; }  // bytes of an incomplete line
  void put(char c) noexcept {
    if (length_ < line_.size())
      line_[length_++] = c;
    else
      ++overlong_;
  }
  // True: the line was a row; time_ns_ and values_ are set.
  bool end_line() noexcept;
  bool read_header(std::string_view line) noexcept;
  bool read_row(std::string_view line) noexcept;

  std::vector<std::string> wanted_;
  std::vector<double> values_;  // by wanted column
  std::vector<char> line_;
  std::size_t length_ = 0, overlong_ = 0;
  std::array<std::int16_t, kMostColumns>
      slot_{};               // by column of the file: index into values_, −1: not wanted
  std::size_t columns_ = 0;  // 0: no header yet
  std::int64_t time_ns_ = 0;
  bool timed_ = false;  // time_ns_ is from a previous row
  ifog_driver_counters counters_{};
};

}  // namespace ifog::capture_rows
