// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <utility>
#include <vector>

#include "drivers/capture/columns/column_names.h"
#include "drivers/ifog/quoted.h"

namespace ifog {
namespace {

constexpr std::size_t kFewBursts = 8;
constexpr double kHole = 1.5;  // times the usual step: a hole, not a longer step

// Four in five are within a fifth of the usual: packets come evenly, holes and jitter do not.
bool are_even(const std::vector<double>& values) {
  const double usual = median_value(values);
  const auto near = std::count_if(values.begin(), values.end(),
                                  [&](double v) { return std::abs(v - usual) <= 0.2 * usual; });
  return 5 * static_cast<std::size_t>(near) >= 4 * values.size();
}

// The longest step within a burst, where rows come in bursts; 0 where they do not.
double step_within_bursts(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return 0.0;
  const double mean_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  std::vector<double> within, between, rows;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double step_s = time_s[i] - time_s[i - 1];
    if (step_s <= mean_s) {
      within.push_back(step_s);
      continue;
    }
    between.push_back(time_s[i] - time_s[begin]);
    rows.push_back(static_cast<double>(i - begin));
    begin = i;
  }
  if (between.size() < kFewBursts || within.size() < between.size()) return 0.0;
  return median_value(within) < 0.25 * mean_s && are_even(between) && are_even(rows) ? mean_s : 0.0;
}

bool same_values(const RowBlock& rows, std::size_t a, std::size_t b) {
  bool any = false;
  for (const std::vector<double>& column : rows.columns) {
    if (column.empty()) continue;
    any = true;
    if (column[a] != column[b] && !(std::isnan(column[a]) && std::isnan(column[b]))) return false;
  }
  return any;
}

// use(of a, of b) for the times, the lines and every column that is there.
template <typename Use>
void for_each_column(RowBlock& a, RowBlock& b, Use use) {
  b.columns.resize(a.columns.size());
  for (std::size_t c = 0; c < a.columns.size(); ++c)
    if (!a.columns[c].empty()) use(a.columns[c], b.columns[c]);
  if (!a.lines.empty()) use(a.lines, b.lines);
  use(a.time_s, b.time_s);
}

void put_before(RowBlock& held, RowBlock& rows) {
  if (held.size() > 0)
    for_each_column(rows, held,
                    [](auto& to, const auto& from) { to.insert(to.begin(), from.begin(), from.end()); });
}

void hold_from(RowBlock& rows, std::size_t from, RowBlock& held) {
  held.origin = rows.origin;
  for_each_column(rows, held, [&](auto& column, auto& kept) {
    kept.assign(column.begin() + static_cast<std::ptrdiff_t>(from), column.end());
    column.resize(from);
  });
}

}  // namespace

RowClock::RowClock(const std::string& path, std::string time, bool keep_repeats, RowNotes& notes, Next next)
    : path_(path),
      time_(time),
      keep_repeats_(keep_repeats),
      notes_(notes),
      next_(std::move(next)),
      order_(path, std::move(time), notes) {}

void RowClock::take(RowBlock& rows) {
  const std::size_t known = held_.size();
  put_before(held_, rows);
  order_.take(rows, known);
  if (!std::exchange(begun_, true)) within_s_ = step_within_bursts(rows.time_s);
  if (!keep_repeats_) drop_repeats(rows);
  std::size_t begin = 0;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    // The first of rows that were spread keeps its stamp.
    const double since_s = rows.time_s[i] - rows.time_s[i - 1];
    if (since_s <= within_s_) continue;
    spread(rows, begin, i, rows.time_s[i]);
    begin = i;
  }
  hold_from(rows, begin, held_);
  if (rows.size() > 0) next_(rows);
}

void RowClock::drop_repeats(RowBlock& rows) {
  std::size_t kept = 1;
  for (std::size_t i = 1; i < rows.size(); ++i) {
    if (rows.time_s[i] == rows.time_s[kept - 1] && same_values(rows, i, kept - 1)) continue;
    rows.move_row(i, kept++);
  }
  repeated_ += rows.size() - kept;
  rows.keep_first(kept);
}

void RowClock::spread(RowBlock& rows, std::size_t begin, std::size_t end, double next_s) {
  const double first_s = rows.time_s[begin], length_s = next_s - first_s;
  const std::size_t count = end - begin;
  double step_s = count == 1 ? length_s : length_s / static_cast<double>(count);
  if (period_s_ > 0.0 && step_s > kHole * period_s_) {
    step_s = period_s_;
  } else {
    period_s_ = step_s;
    bursts_s_ += length_s;
    burst_rows_ += count;
  }
  spread_ += count - 1;
  for (std::size_t i = begin + 1; i < end; ++i)
    rows.time_s[i] = first_s + static_cast<double>(i - begin) * step_s;
}

void RowClock::finish() {
  order_.finish();
  const std::size_t rows = held_.size();
  if (rows > 1) {
    if (!(period_s_ > 0.0))
      fail_at(path_, 0, printable(time_) + " is the same in all rows, expected times, or --sample-rate HZ");
    spread(held_, 0, rows, held_.time_s.front() + static_cast<double>(rows) * period_s_);
  }
  if (rows > 0) next_(held_);
  say();
}

void RowClock::say() {
  if (repeated_ > 0)
    notes_.notices.push_back(path_ + ": " + std::to_string(repeated_) +
                             (repeated_ == 1 ? " row repeats" : " rows repeat") + " the row before and " +
                             (repeated_ == 1 ? "is" : "are") +
                             " left out; --repeats keep reads them as samples");
  if (spread_ == 0) return;
  const double rate_hz = static_cast<double>(burst_rows_) / bursts_s_;
  std::array<char, 32> rate{};
  std::snprintf(rate.data(), rate.size(), "%.6g", rate_hz);
  notes_.notices.push_back(path_ + ": " + std::to_string(spread_) + " rows " +
                           (within_s_ > 0.0 ? "come in bursts" : "have the time of the row before") +
                           " and are spread evenly up to the next time, at " + rate.data() +
                           " Hz; --sample-rate HZ reads all rows as even");
}

}  // namespace ifog
