// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/step_means.h"

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <utility>

#include "drivers/row_times/median.h"
#include "filters/diagnosis/record/even_grid.h"

namespace ifog {
namespace {

// A channel is lost, not between its readings, if it has none for more than this many of their usual distances.
constexpr double kLost = 3.0;
constexpr double kRepeats = 0.6;  // least share of a coarse channel's readings

// Where the channel is lost, its bridged values are used like readings: a spline would not be bound there.
void use_bridges(std::vector<std::uint8_t>& read) {
  std::vector<double> distances;
  std::size_t last = 0;
  for (std::size_t k = 0; k < read.size(); ++k)
    if (read[k] != 0) distances.push_back(static_cast<double>(k - std::exchange(last, k)));
  if (distances.empty()) return;
  const double most = kLost * median(std::move(distances));
  last = 0;
  for (std::size_t k = 0; k <= read.size(); ++k) {
    if (k < read.size() && read[k] == 0) continue;
    if (static_cast<double>(k - last) > most)
      std::fill(read.begin() + static_cast<std::ptrdiff_t>(last),
                read.begin() + static_cast<std::ptrdiff_t>(k), 1);
    last = k;
  }
}

}  // namespace

std::size_t fine_index(const Record& record, std::size_t i, double fine_s) {
  return static_cast<std::size_t>(std::floor((record.time_s[i] - record.time_s[0]) / fine_s + 0.5));
}

StepStarts step_starts(const Record& record, double fine_s, std::size_t steps) {
  StepStarts first;
  first.reserve(steps + 1);
  for (std::size_t i = 0; i < record.time_s.size(); ++i) {
    const std::size_t k = std::min(fine_index(record, i, fine_s), steps - 1);
    while (first.size() <= k) first.push_back(i);
  }
  first.resize(steps + 1, record.time_s.size());
  return first;
}

bool is_coarse(std::span<const double> readings) {
  std::vector<double> changes;
  double last = std::nan(""), least = std::numeric_limits<double>::infinity();
  std::size_t count = 0;
  for (const double value : readings) {
    if (!std::isfinite(value)) continue;
    ++count;
    const double change = std::abs(value - std::exchange(last, value));
    if (change > 0.0) changes.push_back(change), least = std::min(least, change);
  }
  if (changes.empty() || static_cast<double>(changes.size()) > (1.0 - kRepeats) * static_cast<double>(count))
    return false;
  return median(std::move(changes)) < 1.5 * least;
}

StepMeans step_means(std::span<const double> values, const StepStarts& starts, bool with_power, bool holds,
                     bool readings) {
  StepMeans out;
  auto& [means, power, read] = out;
  const std::size_t steps = starts.size() - 1;
  bool any = false;  // steps before the first value use that value
  double held = 0.0;
  for (std::size_t k = 0; k < steps; ++k) {
    double sum = 0.0, square = 0.0, last = 0.0;
    std::uint32_t count = 0;
    for (std::size_t i = starts[k]; i < starts[k + 1]; ++i) {
      if (!std::isfinite(values[i])) continue;
      sum += last = values[i];
      square += values[i] * values[i];
      ++count;
    }
    const double mean = count > 0 ? sum / count : 0.0;
    if (count > 0) held = readings ? last : mean;
    if (count > 0 && !std::exchange(any, true)) std::ranges::fill(means, held);
    const bool empty = starts[k] == starts[k + 1], known = count > 0 || !any || (holds && !empty);
    means.push_back(known ? held : std::nan(""));
    read.push_back(known || empty ? 1 : 0);
    if (with_power) power.push_back(count ? std::max(0.0, square / count - mean * mean) : 0.0);
  }
  // A jump between two readings would have an unrealistic derivative.
  bridge(means, steps);
  std::ranges::replace_if(
      means, [](double mean) { return std::isnan(mean); }, held);
  use_bridges(read);
  return out;
}

}  // namespace ifog
