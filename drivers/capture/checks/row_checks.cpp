// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_checks.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr double kMostImpossible = 0.01;  // of a rate's values; more are no single fault of a logger

std::vector<std::size_t> rates_of(const std::vector<FileColumn>& columns) {
  std::vector<std::size_t> rates;
  for (std::size_t c = 0; c < columns.size(); ++c)
    if (columns[c].rate) rates.push_back(c);
  return rates;
}

std::string treated_as_missing(std::size_t count) {
  return "; " + std::to_string(count) + (count == 1 ? " such cell" : " such cells") + " treated as missing";
}

std::string at(const std::string& path, std::size_t line) { return path + ":" + std::to_string(line) + ": "; }

}  // namespace

std::string what_no_sensor_measures(const std::string& name, std::string_view cell, const Measurable& range) {
  return printable(name) + " is " + in_quotes(cell) + ", which no sensor measures, expected " +
         shortest(range.least) + " to " + shortest(range.most);
}

RowChecks::RowChecks(const std::string& path, const CsvLayout& layout, std::vector<FileColumn> columns,
                     RowSink& sink, RowNotes& notes)
    : path_(path),
      layout_(layout),
      columns_(std::move(columns)),
      notes_(notes),
      rates_(rates_of(columns_)),
      leaps_(rates_, [&sink](RowBlock& rows) { sink.take(rows); }),
      clock_(path, layout.time.value_or(CsvTime{}).header, layout.keep_repeats, notes,
             [this](RowBlock& rows) { behind_clock(rows); }) {
  if (std::any_of(layout.columns.begin(), layout.columns.end(),
                  [](const auto& c) { return c.angle_rad().has_value(); }))
    all_.emplace();
}

void RowChecks::take(RowBlock& rows) {
  if (layout_.chooses()) convert(rows, layout_);
  rows_ += rows.size();
  clock_.take(rows);
}

void RowChecks::behind_clock(RowBlock& rows) {
  look_for_set_clock(rows.time_s);
  last_s_ = rows.time_s.back();
  notes_.add_lines(given_, rows);
  given_ += rows.size();
  if (!all_) return leaps_.take(rows);
  all_->append(rows);
}

void RowChecks::finish(std::span<const ImpossibleValues> found) {
  for (std::size_t c = 0; c < columns_.size(); ++c) tell_impossible(columns_[c], found[c]);
  clock_.finish();
  if (all_) {
    as_rates(*all_, layout_, notes_, path_);
    leaps_.take(*all_);
  }
  leaps_.finish();
  tell_leaps();
  tell_set_clock();
}

void RowChecks::look_for_set_clock(const std::vector<double>& time_s) {
  constexpr double kYear_s = 365.0 * 86'400.0;
  double before_s = given_ > 0 ? last_s_ : time_s.front();
  for (std::size_t row = 0; row < time_s.size() && !clock_set_; ++row) {
    const double step_s = time_s[row] - std::exchange(before_s, time_s[row]);
    if (step_s < kYear_s) continue;
    clock_set_ = given_ + row;
    clock_set_by_s_ = step_s;
  }
}

void RowChecks::tell_set_clock() {
  if (!clock_set_) return;
  notes_.notices.push_back(at(path_, notes_.line_of_row(*clock_set_)) + "its time continues " +
                           std::to_string(std::llround(clock_set_by_s_)) +
                           " s later, as after a clock was set or where two recordings are joined: treated "
                           "as a hole, behind which times are coarser");
}

void RowChecks::tell_impossible(const FileColumn& column, const ImpossibleValues& found) {
  if (found.count == 0) return;
  const std::string what = what_no_sensor_measures(column.name, found.first, column.range);
  const bool few =
      found.count == 1 || static_cast<double>(found.count) <= kMostImpossible * static_cast<double>(rows_);
  if (column.rate && (rows_ == 1 || !few)) {
    std::string more =
        found.count > 1 ? "; nor " + std::to_string(found.count - 1) + " more of its cells" : "";
    if (found.first.find_first_not_of("+-0123456789") == std::string::npos)
      more += "; counts are read by their scale: --column 'rate_x_radps=" + printable(column.name) +
              ":0.00763deg/s'";
    fail_at(path_, found.line, what + more);
  }
  notes_.faults.push_back(at(path_, found.line) + what + treated_as_missing(found.count));
}

void RowChecks::tell_leaps() {
  for (std::size_t r = 0; r < rates_.size(); ++r)
    if (const Leaps::Found& found = leaps_.found()[r]; found.count > 0)
      notes_.faults.push_back(at(path_, notes_.line_of_row(found.first_row)) +
                              printable(columns_[rates_[r]].name) +
                              " says more than half a turn within one sample, from standstill to standstill" +
                              treated_as_missing(found.count));
}

}  // namespace ifog
