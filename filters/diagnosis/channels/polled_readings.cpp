// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/channels/polled_readings.h"

#include <algorithm>
#include <cmath>
#include <set>

namespace ifog {
namespace {

constexpr std::size_t kFewest = 16;    // changes that a beat is read from
constexpr double kShortestPoll = 3.0;  // steps
constexpr double kOff = 0.1;  // of the period, what a change may be off its beat; and a twentieth of a step
constexpr double kOnTheBeat = 0.95;    // of all changes
constexpr std::size_t kFewLevels = 8;  // a switch, a fan of three speeds: they are what they say
constexpr double kMoves = 0.8;         // of the scatter of all readings, the most that a change is
constexpr double kLowQuantile = 0.1;   // of the times between changes: most readings differ, or some do

// A change of the held value; where a step is a mean over the old and the new one, by its share of either.
struct Change {
  double step, before, after;
};

// In one step or two; longer runs are lines over holes, whose ends are readings with a line between them.
std::vector<std::vector<Change>> changes_between_lines(std::span<const double> values) {
  std::vector<std::vector<Change>> parts(1);
  for (std::size_t i = 1; i < values.size(); ++i) {
    if (values[i] == values[i - 1]) continue;
    std::size_t end = i + 1;
    while (end < values.size() && values[end] != values[end - 1]) ++end;
    const double before = values[i - 1], after = values[end - 1];
    const auto at = static_cast<double>(i);
    if (end - i == 1) {
      parts.back().push_back({at, before, after});
    } else if (end - i == 2 && after != before) {
      const double old_share = std::clamp((values[i] - after) / (before - after), 0.0, 1.0);
      parts.back().push_back({at + old_share, before, after});
    } else {
      parts.back().push_back({at - 1.0, before, before});
      parts.push_back({{static_cast<double>(end - 1), after, after}});
    }
    i = end - 1;
  }
  return parts;
}

std::vector<double> times_between(const std::vector<std::vector<Change>>& parts) {
  std::vector<double> between;
  for (const std::vector<Change>& part : parts)
    for (std::size_t i = 1; i < part.size(); ++i)
      if (part[i].before != part[i].after && part[i - 1].before != part[i - 1].after)
        between.push_back(part[i].step - part[i - 1].step);
  return between;
}

// Of which all times between changes are multiples; nothing where they are not.
std::optional<double> beat_of(std::vector<double> between) {
  if (between.size() < kFewest) return std::nullopt;
  const auto low =
      between.begin() + static_cast<std::ptrdiff_t>(kLowQuantile * static_cast<double>(between.size()));
  std::nth_element(between.begin(), low, between.end());
  double period = *low;
  if (period < kShortestPoll) return std::nullopt;
  double steps = 0.0, beats = 0.0;
  for (const double each : between) {
    if (each > 8.0 * period) continue;  // of so many the period would have to be known already
    steps += each;
    beats += std::max(1.0, std::round(each / period));
  }
  period = steps / beats;
  const auto on_beat = std::count_if(between.begin(), between.end(), [&](double each) {
    const double off = each - period * std::round(each / period);
    return std::abs(off) <= kOff * period + 0.05 && each > 0.5 * period;
  });
  if (static_cast<double>(on_beat) < kOnTheBeat * static_cast<double>(between.size())) return std::nullopt;
  return period;
}

// Polled faster than it moves. What leaps from level to level on a beat is set so, and stays there in
// between.
bool moves_between(std::span<const Reading> readings) {
  std::set<double> different;
  double mean = 0.0, change = 0.0, changes = 0.0, scatter = 0.0;
  for (std::size_t i = 0; i < readings.size(); ++i) {
    if (different.size() <= kFewLevels) different.insert(readings[i].value);
    mean += readings[i].value / static_cast<double>(readings.size());
    if (i == 0 || readings[i].value == readings[i - 1].value) continue;
    change += std::pow(readings[i].value - readings[i - 1].value, 2);
    changes += 1.0;
  }
  for (const Reading& each : readings) scatter += std::pow(each.value - mean, 2);
  return different.size() > kFewLevels &&
         change / std::max(changes, 1.0) < kMoves * kMoves * scatter / static_cast<double>(readings.size());
}

}  // namespace

std::optional<PolledReadings> polled_readings(std::span<const double> values) {
  const std::vector<std::vector<Change>> parts = changes_between_lines(values);
  const std::optional<double> period = beat_of(times_between(parts));
  if (!period) return std::nullopt;
  PolledReadings found{*period, {}};
  const auto repeat = [&](double from, double to, double value) {
    const auto beats = static_cast<std::size_t>(std::max(1.0, std::round((to - from) / *period)));
    for (std::size_t k = 1; k < beats; ++k)
      found.readings.push_back(
          {from + (to - from) * static_cast<double>(k) / static_cast<double>(beats), value});
  };
  found.readings.push_back({0.0, values.front()});
  for (const std::vector<Change>& part : parts) {
    bool first = &part != &parts.front();  // behind a line
    for (const Change& each : part) {
      if (!first) repeat(found.readings.back().step, each.step, each.before);
      first = false;
      if (each.step > found.readings.back().step) found.readings.push_back({each.step, each.after});
    }
  }
  repeat(found.readings.back().step, static_cast<double>(values.size()), values.back());
  if (!moves_between(found.readings)) return std::nullopt;
  return found;
}

double on_line(std::span<const Reading> readings, double at) {
  const auto next = std::upper_bound(readings.begin(), readings.end(), at,
                                     [](double step, const Reading& each) { return step < each.step; });
  if (next == readings.begin()) return readings.front().value;
  const Reading& before = *(next - 1);
  if (next == readings.end()) return before.value;
  return before.value + (next->value - before.value) * (at - before.step) / (next->step - before.step);
}

}  // namespace ifog
