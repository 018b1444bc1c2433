// SPDX-License-Identifier: Apache-2.0
// The rows of a CSV capture from its bytes in any portions: `#` lines, a header whose first column is time_s,
// rows. Nothing is allocated after construction.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <span>
#include <string>
#include <string_view>
#include <vector>

namespace ifog::capture_rows {

constexpr std::size_t kMostColumns = 256;    // of a capture
constexpr std::size_t kLongestLine = 16384;  // bytes

struct Counters {
  std::uint64_t good = 0;     // rows
  std::uint64_t format = 0;   // lines that are neither a header with the wanted columns nor a row under it
  std::uint64_t framed = 0;   // bytes of all other lines
  std::uint64_t skipped = 0;  // bytes of these, of lines too long, and of a last line without its end
};

class Rows {
 public:
  explicit Rows(std::vector<std::string> wanted);

  // Calls row(time_ns, values) for each complete row: the wanted columns in the wanted order, NaN where
  // empty.
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
  // What follows is another capture with its own header.
  void restart() noexcept;
  [[nodiscard]] const Counters& counters() const { return counters_; }
  [[nodiscard]] std::size_t waiting() const {
    return length_ + overlong_;
  }  // bytes of a line without its end

 private:
  void put(char c) noexcept {
    if (length_ < line_.size())
      line_[length_++] = c;
    else
      ++overlong_;
  }
  // True: the line was a row, now in time_ns_ and values_.
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
  bool timed_ = false;  // time_ns_ is that of a row before
  Counters counters_;
};

}  // namespace ifog::capture_rows
