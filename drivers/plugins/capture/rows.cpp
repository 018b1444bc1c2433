// SPDX-License-Identifier: Apache-2.0
#include "drivers/plugins/capture/rows.h"

#include <algorithm>
#include <array>
#include <charconv>
#include <cmath>
#include <limits>
#include <utility>

#include "drivers/ifog/decimal.h"

namespace ifog::capture_rows {
namespace {

std::string_view trimmed(std::string_view cell) {
  while (!cell.empty() && (cell.front() == ' ' || cell.front() == '\t')) cell.remove_prefix(1);
  while (!cell.empty() && (cell.back() == ' ' || cell.back() == '\t' || cell.back() == '\r'))
    cell.remove_suffix(1);
  return cell;
}

// Removes the next cell from the line; false after the last.
bool next_cell(std::string_view& line, bool& more, std::string_view& cell) {
  if (!more) return false;
  const std::size_t comma = line.find(',');
  cell = trimmed(line.substr(0, comma));
  more = comma != std::string_view::npos;
  line.remove_prefix(more ? comma + 1 : line.size());
  return true;
}

// Parses a number, or NaN for an empty cell; false otherwise.
bool parse(std::string_view cell, double& value) {
  value = std::numeric_limits<double>::quiet_NaN();
  if (cell.empty()) return true;
  const auto [end, error] = read_decimal(cell.data(), cell.data() + cell.size(), value);
  return error == std::errc() && end == cell.data() + cell.size() && !std::isinf(value);
}

// Nanoseconds of a number of seconds in plain digits, which a double could not resolve; false if it has others.
bool nanoseconds_in(std::string_view cell, std::int64_t& ns) {
  const bool negative = cell.starts_with('-');
  if (negative || cell.starts_with('+')) cell.remove_prefix(1);
  if (cell.find_first_not_of(".0123456789") != std::string_view::npos) return false;
  const std::size_t point = std::min(cell.find('.'), cell.size());
  const std::string_view behind = cell.substr(std::min(point + 1, cell.size()));
  std::array<char, 10> tenths{};  // of a ns
  tenths.fill('0');
  std::copy_n(behind.begin(), std::min(behind.size(), tenths.size()), tenths.begin());
  std::int64_t whole = 0, part = 0;
  std::from_chars(cell.data(), cell.data() + point, whole);
  std::from_chars(tenths.data(), tenths.data() + tenths.size(), part);
  ns = whole * 1'000'000'000 + (part + 5) / 10;
  if (negative) ns = -ns;
  return true;
}

}  // namespace

Rows::Rows(std::vector<std::string> wanted)
    : wanted_(std::move(wanted)), values_(wanted_.size()), line_(kLongestLine) {}

void Rows::restart() noexcept {
  counters_.bytes_skipped += length_ + overlong_;
  length_ = overlong_ = 0;
  columns_ = 0;
  timed_ = false;
}

bool Rows::end_line() noexcept {
  const std::size_t bytes = waiting() + 1;  // including its end
  const std::string_view line = trimmed({line_.data(), std::exchange(length_, 0)});
  const std::size_t beyond = std::exchange(overlong_, 0);
  const bool remark = beyond == 0 && (line.empty() || line.front() == '#');
  const bool row = columns_ > 0;
  if (remark || (beyond == 0 && (row ? read_row(line) : read_header(line)))) {
    counters_.bytes_framed += bytes;
    counters_.frames_good += row && !remark ? 1 : 0;
    return row && !remark;
  }
  ++counters_.frames_format;
  counters_.bytes_skipped += bytes;
  return false;
}

bool Rows::read_header(std::string_view line) noexcept {
  std::size_t column = 0, found = 0;
  std::string_view cell;
  for (bool more = true; next_cell(line, more, cell); ++column) {
    if (column == kMostColumns || (column == 0 && cell != "time_s")) return false;
    const auto at = std::find(wanted_.begin(), wanted_.end(), cell);
    slot_[column] = static_cast<std::int16_t>(at == wanted_.end() ? -1 : at - wanted_.begin());
    for (std::size_t before = 0; at != wanted_.end() && before < column; ++before)
      if (slot_[before] == slot_[column]) return false;
    if (at != wanted_.end()) ++found;
  }
  if (found != wanted_.size()) return false;
  columns_ = column;
  return true;
}

bool Rows::read_row(std::string_view line) noexcept {
  constexpr double kMostSeconds = 9e9;  // limit of int64 in ns
  std::size_t column = 0;
  std::int64_t time_ns = 0;
  std::string_view cell;
  for (bool more = true; next_cell(line, more, cell); ++column) {
    double value = 0.0;
    if (column == columns_ || !parse(cell, value)) return false;
    if (column == 0) {
      if (!(std::abs(value) < kMostSeconds)) return false;
      if (!nanoseconds_in(cell, time_ns)) time_ns = std::llround(value * 1e9);
      if (timed_ && time_ns <= time_ns_) return false;
    } else if (slot_[column] >= 0) {
      values_[static_cast<std::size_t>(slot_[column])] = value;
    }
  }
  if (column != columns_) return false;
  time_ns_ = time_ns;
  timed_ = true;
  return true;
}

}  // namespace ifog::capture_rows
