// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/checks/row_clock.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <iterator>
#include <numeric>
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
// No pause between bursts is as long in usual ones, and no late row in ticks; longer ones are holes.
constexpr double kLongPause = 16.0, kLateTicks = 4.0;

// True if four of five are within 20 % of the median: packets are even, gaps and jitter are not.
bool are_even(const std::vector<double>& values) {
  const double usual = median(values);
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

// True for stamps of a clock whose tick is the sample period: most steps are one tick, and a late row's longer one is
// made up by none.
bool are_ticks(const std::vector<double>& steps) {
  const double tick = median(steps);
  const auto count = [&](auto is) {
    return 100 * static_cast<std::size_t>(std::ranges::count_if(steps, is));
  };
  const std::size_t none = count([](double step) { return step == 0.0; });
  return tick > 0.0 && none >= steps.size() &&
         2 * none >= count([=](double s) { return s > kHole * tick; }) &&
         count([=](double s) { return std::abs(s - tick) <= 1e-3 * tick; }) >= 50 * steps.size();
}

// Mean step and the shortest hole: without the steps that are longer than the usual pauses.
std::pair<double, double> mean_and_hole(const std::vector<double>& steps) {
  double mean_s = 0.0, hole_s = std::numeric_limits<double>::infinity();
  for (int round = 0; round < 4; ++round) {
    std::vector<double> kept, pauses;
    std::ranges::copy_if(steps, std::back_inserter(kept), [&](double step) { return step < hole_s; });
    mean_s = std::accumulate(kept.begin(), kept.end(), 0.0) / static_cast<double>(kept.size());
    std::ranges::copy_if(kept, std::back_inserter(pauses), [&](double step) { return step > mean_s; });
    if (!pauses.empty()) hole_s = kLongPause * median(std::move(pauses));
  }
  return {mean_s, hole_s};
}

Bursts bursts_of(const std::vector<double>& time_s) {
  if (time_s.size() < 2) return {};
  std::vector<double> steps(time_s.size());
  std::adjacent_difference(time_s.begin(), time_s.end(), steps.begin());
  steps.erase(steps.begin());
  const auto [mean_s, hole_s] = mean_and_hole(steps);
  std::vector<double> within, between, rows, departure;
  std::size_t begin = 0;
  double elapsed_s = 0.0, begun_s = 0.0;  // without holes
  for (std::size_t i = 1; i < time_s.size(); ++i) {
    const double step_s = steps[i - 1] < hole_s ? steps[i - 1] : mean_s;
    if (step_s <= mean_s) {
      within.push_back(step_s);
    } else {
      between.push_back(elapsed_s + step_s - begun_s);
      rows.push_back(static_cast<double>(i - begin));
      departure.push_back(static_cast<double>(i) - elapsed_s / mean_s);
      begin = i;
      begun_s = elapsed_s + step_s;
    }
    elapsed_s += step_s;
  }
  const bool bursts = between.size() >= kFewBursts && within.size() >= between.size() &&
                      (median(rows) < kWindowRows || !are_even(within)) && median(within) < 0.25 * mean_s;
  if (bursts && are_even(between) && are_even(rows)) return {mean_s};
  if (bursts && are_late(departure)) return {mean_s, kLateRows, hole_s};
  return are_ticks(steps) ? Bursts{0.0, kLateRows, kLateTicks * median(steps)} : Bursts{};
}

// True if most rows that repeat the one before, with its time, do so by chance, as coarse values do: then rows
// seven apart are equal, too. With r and c, the shares of these: (r - c) / (1 - c) true repeats against c of the rest.
bool repeat_by_chance(const RowBlock& rows) {
  constexpr std::size_t kApart = 7;
  std::size_t all = 0, timed = 0, repeated = 0, equal = 0;
  for (std::size_t i = kApart; i < rows.size(); ++i, ++all) {
    const bool same_time = rows.time_s[i] == rows.time_s[i - 1];
    timed += same_time ? 1 : 0;
    repeated += same_time && rows.cells[i] == rows.cells[i - 1] ? 1 : 0;
    equal += rows.cells[i] == rows.cells[i - kApart] ? 1 : 0;
  }
  return repeated * (all + equal) < 2 * equal * timed;
}

}  // namespace

double RowOrder::rolled_over_s(double now_s, std::size_t line) {
  const auto found = std::ranges::find_if(kRollovers, [&](const Rollover& each) {
    return last_s_ - offset_s_ < each.length_s && now_s + each.length_s > last_s_ &&
           now_s + each.length_s <= last_s_ + kLate_s;
  });
  if (found == kRollovers.end()) return 0.0;
  notes_.notice(line, printable(time_) + " rolls over, as " + found->what +
                          " does: " + shortest(found->length_s) + " s are added from there on");
  return found->length_s;
}

// How many rows that go back and increase are another recording: some in its first half, as of one that begins; later,
// where a clock was set, more than can be dropped.
std::size_t RowOrder::enough(double now_s) const {
  if (joined_ == kFew) return std::numeric_limits<std::size_t>::max();
  return now_s - first_s_ > 0.5 * (last_s_ - first_s_) ? std::max(kFew, rows_ / kRowsAFault) : kFew;
}

// The rows after the last one that go back: dropped, or of another recording. False: the next rows decide.
bool RowOrder::settle_back(const RowBlock& rows, std::size_t& row, bool is_last) {
  const double now_s = rows.time_s[row] + offset_s_;
  const std::size_t wanted = enough(now_s);
  std::size_t end = row + 1, increasing = 1;
  const auto step_s = [&] { return rows.time_s[end] - rows.time_s[end - 1]; };
  for (; end < rows.size() && increasing < wanted && step_s() >= 0.0; ++end) {
    if (rows.time_s[end] + offset_s_ >= last_s_) break;
    increasing += step_s() > 0.0 ? 1 : 0;
  }
  if (increasing >= wanted) {
    ++joined_;
    first_s_ = last_s_ + kBetween_s;
    offset_s_ += first_s_ - now_s;
    std::string at = " begins again at ";
    append_time(at, rows.origin, rows.time_s[row]);
    tell_joined(rows.lines[row], at + " s");
    return true;
  }
  if (end == rows.size() && !is_last && joined_ < kFew) return false;
  falling_ += end < rows.size() && step_s() < 0.0 ? 1 : 0;
  for (; row < end; ++row, ++rows_) drop(rows, row, false);
  return true;
}

void RowOrder::tell_joined(std::size_t line, const std::string& how) {
  notes_.notice(line, printable(time_) + how +
                          ", as after a clock was set or where two recordings are joined: treated as a hole");
}

void RowOrder::take(RowBlock& rows, bool is_last) {
  buffered_.append(rows);
  std::swap(buffered_, rows);
  std::size_t kept = rows_ > 0 ? 1 : 0, i = kept;
  while (i < rows.size()) {
    const double now_s = rows.time_s[i] + offset_s_;
    if (rows_ > 0 && now_s < last_s_) {
      if (const double longer_s = rolled_over_s(now_s, rows.lines[i]); longer_s > 0.0) {
        offset_s_ += longer_s;
      } else if (now_s >= before_s_) {  // this row continues those before the last one, which is wrong
        drop(rows, --kept, true);
        last_s_ = before_s_;
      } else if (!settle_back(rows, i, is_last)) {
        break;
      }
      continue;
    }
    if (last_s_ - before_s_ >= kYear_s && !std::exchange(set_, true))
      tell_joined(line_, " continues " + std::to_string(std::llround(last_s_ - before_s_)) + " s later");
    if (rows_++ == 0)
      first_s_ = now_s;
    else
      before_s_ = last_s_;
    last_s_ = now_s;
    line_ = rows.lines[i];
    rows.move_row(i++, kept);
    rows.time_s[kept++] = now_s;
  }
  const std::size_t ordered = kept;
  while (i < rows.size()) rows.move_row(i++, kept++);
  rows.keep_first(kept);
  if (!is_last) rows.split_off(std::max<std::size_t>(ordered, 1) - 1, buffered_);
}

void RowOrder::drop(const RowBlock& rows, std::size_t row, bool late) {
  std::string what;
  if (dropped_.count == 0) {
    what = printable(time_) + " is ";
    append_time(what, rows.origin, rows.time_s[row] - (late ? offset_s_ : 0.0));
    what += late ? " s, expected less than in the next row" : " s, expected more than in the row before";
  }
  dropped_.add(rows.lines[row], std::move(what));
}

void RowOrder::finish() {
  const std::size_t count = dropped_.count;
  if (count == 0) return;
  const bool falls = 2 * falling_ >= count && 2 * count > rows_;
  if (falls || rows_ < kRowsAFault * count)
    notes_.refuse(
        dropped_.line,
        dropped_.first +
            (falls ? "; times decrease from row to row, as of a recording written backwards: 'tac' turns them"
             : count > 1 ? "; so are " + std::to_string(count - 1) + " more rows"
                         : "") +
            (joined_ == kFew ? "; of sensors whose rows stand in blocks --only COLUMN=VALUE reads one"
                             : "; --sample-rate HZ reads all rows as even"));
  notes_.dropped(dropped_, "row");
}

RowClock::RowClock(const std::string& time, bool keep_repeats, RowNotes& notes, Next next)
    : time_(time), keep_repeats_(keep_repeats), notes_(notes), next_(std::move(next)), order_(time_, notes) {}

void RowClock::take(RowBlock& rows) {
  if (!begun_) keep_repeats_ = keep_repeats_ || repeat_by_chance(rows);
  drop_repeats(rows);
  order_.take(rows, false);
  if (!std::exchange(begun_, true)) bursts_ = bursts_of(rows.time_s);
  spread_bursts(rows);
}

// Hands on all rows but those of the last burst.
void RowClock::spread_bursts(RowBlock& rows) {
  buffered_.append(rows);
  std::swap(buffered_, rows);
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
  for (; end < rows.size(); ++end) {
    const double step_s = rows.time_s[end] - rows.time_s[end - 1];
    if (step_s > bursts_.within_s && (end - begin >= bursts_.rows || step_s >= bursts_.hole_s)) break;
  }
  return end;
}

void RowClock::drop_repeats(RowBlock& rows) {
  if (keep_repeats_) return;
  std::size_t kept = 0;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    const Row row{rows.time_s[i], rows.cells[i]};
    if (std::exchange(last_, row) != row) rows.move_row(i, kept++);
  }
  repeated_ += rows.size() - kept;
  rows.keep_first(kept);
}

void RowClock::spread(RowBlock& rows, std::size_t begin, std::size_t end, double next_s) {
  const double first_s = rows.time_s[begin], length_s = next_s - first_s;
  const std::size_t count = end - begin;
  double step_s = count == 1 ? length_s : length_s / static_cast<double>(count);
  const bool hole = count > 1 && next_s - rows.time_s[end - 1] >= bursts_.hole_s;
  if (period_s_ > 0.0 && (hole || step_s > kHole * period_s_)) {
    step_s = period_s_;
  } else {
    period_s_ = step_s;
  }
  spread_ += count - 1;
  for (std::size_t i = begin + 1; i < end; ++i)
    rows.time_s[i] = first_s + static_cast<double>(i - begin) * step_s;
}

void RowClock::finish() {
  RowBlock last_ones;
  order_.take(last_ones, true);
  order_.finish();
  spread_bursts(last_ones);
  const std::size_t rows = buffered_.size();
  const std::size_t end = end_of_burst(buffered_, 0),
                    last = end < rows ? end : 0;  // the last burst's first row
  if (last > 0) spread(buffered_, 0, last, buffered_.time_s[last]);
  if (rows > last + 1) {
    if (!(period_s_ > 0.0))
      notes_.refuse(0, printable(time_) + " is the same in all rows, expected times, or --sample-rate HZ");
    spread(buffered_, last, rows, buffered_.time_s[last] + static_cast<double>(rows - last) * period_s_);
  }
  if (rows > 0) next_(buffered_);
  say();
}

void RowClock::say() {
  if (repeated_ > 0)
    notes_.notice(0, std::to_string(repeated_) + (repeated_ == 1 ? " row repeats" : " rows repeat") +
                         " the row before and " + (repeated_ == 1 ? "is" : "are") +
                         " dropped; --repeats keep reads them as samples");
  if (spread_ == 0) return;
  notes_.notice(0, std::to_string(spread_) + " rows " +
                       (bursts_.within_s > 0.0 ? "come in bursts"
                        : bursts_.rows > 1     ? "have times as coarse as their steps"
                                               : "have the time of the row before") +
                       " and are spread evenly up to the next time; --sample-rate HZ reads all rows as even");
}

}  // namespace ifog
