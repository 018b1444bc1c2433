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

constexpr double kLate_s = 2.0;  // limit for a rollover
constexpr double kYear_s = 365.0 * 86'400.0;

constexpr std::size_t kFew = 8;     // rows that show an earlier time to go on; recordings in one file
constexpr double kBetween_s = 1.0;  // hole between two recordings in one file

std::size_t line_of(const RowBlock& rows, std::size_t row) {
  return rows.lines.empty() ? 0 : rows.lines[row];
}

struct Rollover {
  double length_s;
  const char* what;
};
constexpr std::array<Rollover, 7> kRollovers{{{604'800.0, "a GPS week"},
                                              {86'400.0, "a day"},
                                              {3600.0, "an hour"},
                                              {0x1p32 * 1e-6, "a count of µs in 32 bits"},
                                              {0x1p32 * 1e-4, "a count of 100 µs in 32 bits"},
                                              {0x1p32 * 1e-3, "a count of ms in 32 bits"},
                                              {0x1p16 * 1e-3, "a count of ms in 16 bits"}}};

constexpr std::size_t kFewBursts = 8, kLateBursts = 16, kLateRows = 128;
// No packet has as many rows; a logger that records for some seconds now and then has them, at even times.
constexpr double kWindowRows = 32.0;
constexpr double kHole = 1.5;  // times the usual step; longer steps are gaps

// True if four of five are within 20 % of the median: packets are even, gaps and jitter are not.
bool are_even(const std::vector<double>& values) {
  const double usual = median_value(values);
  const auto near =
      std::ranges::count_if(values, [&](double v) { return std::abs(v - usual) <= 0.2 * usual; });
  return 5 * static_cast<std::size_t>(near) >= 4 * values.size();
}

// True if the number of rows stays near a line in time, because a long pause is followed by many rows: the departures at
// the ends of bursts scatter over 16 bursts as over one. Those of losses add up, to 16 times the variance.
bool are_late(const std::vector<double>& departure) {
  const auto squares = [&](std::size_t apart) {
    double sum = 0.0;
    for (std::size_t i = apart; i < departure.size(); ++i)
      sum += std::pow(departure[i] - departure[i - apart], 2.0);
    return sum;
  };
  return departure.size() > kLateBursts * kLateBursts && squares(kLateBursts) < 4.0 * squares(1);
}

Bursts bursts_of(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return {};
  const double mean_s = (time_s.back() - time_s.front()) / static_cast<double>(time_s.size() - 1);
  std::vector<double> within, between, rows, departure;
  std::size_t begin = 0;
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double step_s = time_s[i] - time_s[i - 1];
    if (step_s <= mean_s) {
      within.push_back(step_s);
      continue;
    }
    between.push_back(time_s[i] - time_s[begin]);
    rows.push_back(static_cast<double>(i - begin));
    departure.push_back(static_cast<double>(i) - time_s[i - 1] / mean_s);
    begin = i;
  }
  if (between.size() < kFewBursts || within.size() < between.size()) return {};
  if (median_value(rows) >= kWindowRows && are_even(within)) return {};
  if (median_value(within) >= 0.25 * mean_s) return {};
  if (are_even(between) && are_even(rows)) return {mean_s};
  return are_late(departure) ? Bursts{mean_s, kLateRows} : Bursts{};
}

bool same_values(const RowBlock& rows, std::size_t a, std::size_t b) {
  return !rows.columns.empty() && std::ranges::all_of(rows.columns, [&](const std::vector<double>& column) {
    return column[a] == column[b] || (std::isnan(column[a]) && std::isnan(column[b]));
  });
}

// True if most rows that repeat the one before, with its time, do so by chance, as coarse values do: then rows
// seven apart are equal, too. With r and c, the shares of these: (r - c) / (1 - c) true repeats against c of the rest.
bool repeat_by_chance(const RowBlock& rows) {
  constexpr std::size_t kApart = 7;
  std::size_t all = 0, timed = 0, repeated = 0, equal = 0;
  for (std::size_t i = kApart; i < rows.size(); ++i, ++all) {
    const bool same_time = rows.time_s[i] == rows.time_s[i - 1];
    timed += same_time ? 1 : 0;
    repeated += same_time && same_values(rows, i, i - 1) ? 1 : 0;
    equal += same_values(rows, i, i - kApart) ? 1 : 0;
  }
  return repeated * (all + equal) < 2 * equal * timed;
}

}  // namespace

RowOrder::RowOrder(const std::string& path, std::string time, RowNotes& notes)
    : path_(path), time_(std::move(time)), notes_(notes) {}

double RowOrder::rolled_over_s(double now_s, std::size_t line) {
  const auto found = std::ranges::find_if(kRollovers, [&](const Rollover& each) {
    return last_s_ - offset_s_ < each.length_s && now_s + each.length_s > last_s_ &&
           now_s + each.length_s <= last_s_ + kLate_s;
  });
  if (found == kRollovers.end()) return 0.0;
  notes_.notices.push_back(path_ + ":" + std::to_string(line) + ": " + printable(time_) + " rolls over, as " +
                           found->what + " does: " + shortest(found->length_s) +
                           " s are added from there on");
  return found->length_s;
}

// True if a time that goes back is the last of some that do and increase: of another recording, which begins in the first
// half of this one, or before it. These were dropped, except this one.
bool RowOrder::begins_again(const RowBlock& rows, std::size_t row) {
  const double now_s = rows.time_s[row] + offset_s_;
  falling_ += back_ > 0 && now_s < back_s_ ? 1 : 0;
  back_ = now_s >= back_s_ ? back_ + 1 : 1;
  back_s_ = now_s;
  if (back_ < kFew || joined_ == kFew || now_s - first_s_ > 0.5 * (last_s_ - first_s_)) return false;
  back_ = 0;
  dropped_.count -= kFew - 1;
  ++joined_;
  first_s_ = last_s_ + kBetween_s;
  offset_s_ += first_s_ - now_s;
  std::string at = " begins again at ";
  append_time(at, rows.origin, rows.time_s[row]);
  tell_joined(line_of(rows, row), at + " s, and " + std::to_string(kFew - 1) + " rows before are dropped");
  return true;
}

void RowOrder::tell_joined(std::size_t line, const std::string& how) {
  notes_.notices.push_back(
      path_ + ":" + std::to_string(line) + ": " + printable(time_) + how +
      ", as after a clock was set or where two recordings are joined: treated as a hole");
}

void RowOrder::take(RowBlock& rows, std::size_t known) {
  std::size_t kept = known;
  for (std::size_t i = known; i < rows.size(); ++i) {
    double now_s = rows.time_s[i] + offset_s_;
    const bool back = rows_++ > 0 && now_s < last_s_;
    if (const double longer_s = back ? rolled_over_s(now_s, line_of(rows, i)) : 0.0; longer_s > 0.0) {
      offset_s_ += longer_s;
      now_s += longer_s;
    } else if (back && begins_again(rows, i)) {
      now_s = first_s_;
    } else if (back) {
      // If this row continues those before the last one, the last one is wrong.
      const bool last_is_late = now_s >= before_s_;
      drop(rows, last_is_late ? kept - 1 : i, last_is_late);
      if (!last_is_late) continue;
      --kept;
      last_s_ = before_s_;
    } else if (last_s_ - before_s_ >= kYear_s && !std::exchange(set_, true)) {
      tell_joined(line_, " continues " + std::to_string(std::llround(last_s_ - before_s_)) + " s later");
    }
    if (!back) back_ = 0;
    if (rows_ == 1) first_s_ = now_s;
    if (rows_ > 1) before_s_ = last_s_;
    last_s_ = now_s;
    line_ = line_of(rows, i);
    rows.move_row(i, kept);
    rows.time_s[kept++] = now_s;
  }
  rows.keep_first(kept);
}

void RowOrder::drop(const RowBlock& rows, std::size_t row, bool late) {
  std::string what;
  if (dropped_.count == 0) {
    what = printable(time_) + " is ";
    append_time(what, rows.origin, rows.time_s[row] - (late ? offset_s_ : 0.0));
    what += late ? " s, expected less than in the next row" : " s, expected more than in the row before";
  }
  dropped_.add(line_of(rows, row), std::move(what));
}

void RowOrder::finish() {
  const std::size_t count = dropped_.count;
  if (count == 0) return;
  const bool falls = 2 * falling_ >= count && 2 * count > rows_;
  if (falls || rows_ < kRowsAFault * count)
    fail_at(
        path_, dropped_.line,
        dropped_.first +
            (falls ? "; times decrease from row to row, as of a recording written backwards: 'tac' turns them"
             : count > 1 ? "; so are " + std::to_string(count - 1) + " more rows"
                         : "") +
            "; --sample-rate HZ reads all rows as even");
  notes_.faults.push_back(dropped_.dropped(path_, "row"));
}

RowClock::RowClock(const std::string& path, std::string time, bool keep_repeats, RowNotes& notes, Next next)
    : path_(path),
      time_(time),
      keep_repeats_(keep_repeats),
      notes_(notes),
      next_(std::move(next)),
      order_(path, std::move(time), notes) {}

void RowClock::take(RowBlock& rows) {
  const std::size_t known = buffered_.size();
  buffered_.append(rows);
  std::swap(buffered_, rows);
  order_.take(rows, known);
  if (!std::exchange(begun_, true)) {
    bursts_ = bursts_of(rows.time_s);
    keep_repeats_ = keep_repeats_ || repeat_by_chance(rows);
  }
  if (!keep_repeats_) drop_repeats(rows);
  std::vector<double>& time_s = rows.time_s;
  std::size_t begin = 0;
  for (std::size_t end; (end = end_of_burst(rows, begin)) < rows.size(); begin = end) {
    if (!(period_s_ > 0.0)) {
      // A first burst of fewer rows than the next one may have begun before the record.
      const std::size_t next = end_of_burst(rows, end);
      if (next == rows.size()) break;
      const double next_step_s = (time_s[next] - time_s[end]) / static_cast<double>(next - end);
      if (end > 1 && next - end > end)
        time_s[0] = std::max(time_s[0], time_s[end] - static_cast<double>(end) * next_step_s);
    }
    spread(rows, begin, end, time_s[end]);
  }
  rows.split_off(begin, buffered_);
  if (rows.size() > 0) next_(rows);
}

std::size_t RowClock::end_of_burst(const RowBlock& rows, std::size_t begin) const {
  std::size_t end = begin + 1;
  while (end < rows.size() &&
         (end - begin < bursts_.rows || rows.time_s[end] - rows.time_s[end - 1] <= bursts_.within_s))
    ++end;
  return end;
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
  }
  spread_ += count - 1;
  for (std::size_t i = begin + 1; i < end; ++i)
    rows.time_s[i] = first_s + static_cast<double>(i - begin) * step_s;
}

void RowClock::finish() {
  order_.finish();
  const std::size_t rows = buffered_.size();
  const std::size_t end = end_of_burst(buffered_, 0),
                    last = end < rows ? end : 0;  // the last burst's first row
  if (last > 0) spread(buffered_, 0, last, buffered_.time_s[last]);
  if (rows > last + 1) {
    if (!(period_s_ > 0.0))
      fail_at(path_, 0, printable(time_) + " is the same in all rows, expected times, or --sample-rate HZ");
    spread(buffered_, last, rows, buffered_.time_s[last] + static_cast<double>(rows - last) * period_s_);
  }
  if (rows > 0) next_(buffered_);
  say();
}

void RowClock::say() {
  if (repeated_ > 0)
    notes_.notices.push_back(path_ + ": " + std::to_string(repeated_) +
                             (repeated_ == 1 ? " row repeats" : " rows repeat") + " the row before and " +
                             (repeated_ == 1 ? "is" : "are") +
                             " dropped; --repeats keep reads them as samples");
  if (spread_ == 0) return;
  notes_.notices.push_back(
      path_ + ": " + std::to_string(spread_) + " rows " +
      (bursts_.within_s > 0.0 ? "come in bursts" : "have the time of the row before") +
      " and are spread evenly up to the next time; --sample-rate HZ reads all rows as even");
}

}  // namespace ifog
