// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/value_faults.h"

#include <algorithm>
#include <cmath>
#include <limits>
#include <numbers>
#include <numeric>
#include <span>
#include <utility>

#include "filters/allan/runs.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kMostSamples = 1'000'000, kFewSamples = 256;
constexpr double kDegree = std::numbers::pi / 180.0;
constexpr double kMostBias_radps = 5.0 * kDegree;

std::string six(double value) { return formatted("%.6g", value); }

std::vector<double> values_of(std::span<const double> rate, std::span<const Stretch> parts) {
  std::vector<double> out;
  for (const Stretch& part : parts) {
    const std::size_t count = std::min(part.size(), kMostSamples - out.size());
    const std::span<const double> values = rate.subspan(part.begin, count);
    out.insert(out.end(), values.begin(), values.end());
  }
  return out;
}

void find_held(const std::vector<double>& values, double period_s, std::vector<ValueFault>& found) {
  const Stretch all{0, values.size()};
  const std::size_t held = held_samples(values, {&all, 1});
  if (held == 1) return;
  found.push_back({"held", "each value stands " + std::to_string(held) + " times: the sensor's own rate is " +
                               six(1.0 / (period_s * static_cast<double>(held))) +
                               " Hz, and figures below that period are the logger's"});
}

// In most stretches two values are 99 % while the noise is below 0.21 to 0.39 of their distance, by the level.
void find_coarse(const std::vector<double>& values, std::vector<ValueFault>& found) {
  double step = std::numeric_limits<double>::infinity();
  std::size_t stretches = 0, coarse = 0;
  std::vector<double> some(kFewSamples);
  for (std::size_t i = 0; i + kFewSamples <= values.size(); i += kFewSamples, ++stretches) {
    std::copy_n(values.begin() + static_cast<std::ptrdiff_t>(i), kFewSamples, some.begin());
    std::ranges::sort(some);
    Run first{}, second{};  // the two most frequent values
    const Stretch all{0, some.size()};
    for_each_run(some, {&all, 1}, [&](const Run& run) {
      if (run.length > first.length)
        second = std::exchange(first, run);
      else if (run.length > second.length)
        second = run;
    });
    if (100 * (first.length + second.length) < 99 * kFewSamples) continue;
    ++coarse;
    if (second.length > 0) step = std::min(step, std::abs(first.value - second.value));
  }
  if (2 * coarse <= stretches || !std::isfinite(step)) return;
  found.push_back({"coarse", "most stretches of 256 samples hold nearly only one or two values, " +
                                 six(step * 3600.0 / kDegree) +
                                 " °/h apart: the noise is below the resolution, and the figures are not "
                                 "the sensor's"});
}

void find_clipped(const std::vector<double>& sorted, std::vector<ValueFault>& found) {
  std::vector<Run> values;  // in ascending order
  const Stretch all{0, sorted.size()};
  for_each_run(sorted, {&all, 1}, [&](const Run& run) { values.push_back(run); });
  const auto samples = static_cast<double>(sorted.size()),
             average = samples / static_cast<double>(values.size());
  const auto clipped = [&](const Run& extreme, const Run& next, const char* which) {
    const auto here = static_cast<double>(extreme.length), there = static_cast<double>(next.length);
    if (100.0 * here < samples || here < 3.0 * std::max(there, average)) return;
    found.push_back({"clipped", six(100.0 * here / samples) + " % of the samples are at the " + which +
                                    " value, " + six(extreme.value / kDegree) +
                                    " °/s: the sensor or its number format is at full scale, and the figures "
                                    "are of what it cut off"});
  };
  clipped(values.back(), values[values.size() - 2], "largest");
  clipped(values.front(), values[1], "smallest");
}

void find_wrapped(const std::vector<double>& values, const std::vector<double>& sorted,
                  std::vector<ValueFault>& found) {
  const double low = sorted.front(), high = sorted.back(), range = high - low;
  const auto inside = std::ranges::lower_bound(sorted, high - 0.2 * range) -
                      std::ranges::upper_bound(sorted, low + 0.2 * range);
  const bool two_values = std::ranges::upper_bound(sorted, low) == std::ranges::lower_bound(sorted, high);
  if (inside > 0 || two_values) return;
  const auto above = sorted.end() - std::ranges::upper_bound(sorted, low + 0.5 * range);
  std::size_t across = 0;
  for (std::size_t i = 1; i < values.size(); ++i)
    across += std::abs(values[i] - values[i - 1]) > 0.6 * range ? 1 : 0;
  if (100 * across < values.size()) return;
  found.push_back({"wrapped", six(100.0 * static_cast<double>(above) / static_cast<double>(values.size())) +
                                  " % of the samples stand about " + six(range / kDegree) +
                                  " °/s above the others, none between: signed counts read as unsigned"});
}

void find_implausible(const std::vector<double>& values, std::vector<ValueFault>& found) {
  const double mean = std::accumulate(values.begin(), values.end(), 0.0) / static_cast<double>(values.size());
  if (std::abs(mean) > kMostBias_radps)
    found.push_back({"unit", "the mean at rest is " + six(mean / kDegree) +
                                 " °/s, more than the bias of any gyro: is it at rest, and is the unit right "
                                 "(deg/h by --column)?"});
}

}  // namespace

void find_value_faults(std::span<const double> rate, std::span<const Stretch> parts, double period_s,
                       std::vector<ValueFault>& found) {
  const std::vector<double> values = values_of(rate, parts);
  if (values.size() < kFewSamples) return;
  std::vector<double> sorted = values;
  std::ranges::sort(sorted);
  if (sorted.front() == sorted.back()) return;
  const std::size_t before = found.size();
  find_held(values, period_s, found);
  if (found.size() == before) find_coarse(values, found);
  if (found.size() == before) find_wrapped(values, sorted, found);
  find_clipped(sorted, found);
  find_implausible(values, found);
}

}  // namespace ifog
