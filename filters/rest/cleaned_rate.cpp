// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/cleaned_rate.h"

#include <algorithm>
#include <cmath>
#include <string>
#include <utility>

#include "filters/rest/glitches.h"
#include "filters/rest/runs.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kStuck = 8;  // equal samples in a row

// Empty if repeated values are normal in this record.
std::vector<Stretch> stuck_runs(const SeriesView& rate, std::span<const Stretch> parts) {
  std::vector<Stretch> stuck;
  Repeats repeats;
  for_each_run(rate, parts, [&](const Run& run) {
    repeats.add(run);
    if (run.length >= kStuck) stuck.push_back({run.begin, run.begin + run.length});
  });
  if (!repeats.are_rare() || repeats.runs <= 16) stuck.clear();
  return stuck;
}

std::string in_words(const std::vector<Stretch>& stuck, const TimeOfSample& time_s) {
  const std::size_t longest = std::ranges::max_element(stuck, {}, &Stretch::size)->size();
  return "stands still for up to " + std::to_string(longest) + " samples, " + std::to_string(stuck.size()) +
         (stuck.size() == 1 ? " time" : " times") + ", first at " + told_time(time_s(stuck.front().begin)) +
         " s: the sensor or the logger repeated a value, dropped";
}

struct Replacement {
  Stretch samples;
  double value = 0.0;
};

std::optional<LongSeries> with(const SeriesView& rate, std::vector<Replacement> replacements) {
  if (replacements.empty()) return std::nullopt;
  std::ranges::sort(replacements, {}, [](const Replacement& each) { return each.samples.begin; });
  std::optional<LongSeries> out(std::in_place);
  std::vector<double> repaired;
  auto next = replacements.begin();
  for_each_piece(rate, 0, rate.size(), [&](std::span<const double> values, std::size_t first) {
    const std::size_t end = first + values.size();
    repaired.assign(values.begin(), values.end());
    for (; next != replacements.end() && next->samples.begin < end; ++next) {
      const std::size_t from = std::max(next->samples.begin, first), to = std::min(next->samples.end, end);
      std::fill_n(repaired.begin() + static_cast<std::ptrdiff_t>(from - first), to - from, next->value);
      if (next->samples.end > end) break;  // the rest is in the next piece
    }
    out->add(repaired);
  });
  return out;
}

std::vector<Replacement> leaps_in(const SeriesView& rate, const SeriesView& error,
                                  std::span<const Stretch> parts, LeapOf of, const TimeOfSample& time_s,
                                  std::vector<ValueFault>& faults) {
  const Glitches leaps = find_glitches(error, parts, of);
  if (leaps.count > 0) faults.push_back({"leaps", in_words(leaps, time_s)});
  std::vector<Replacement> out;
  for (const auto& [at, between] : leaps.few)
    out.push_back({{at, at + 1}, between + (rate.at(at) - error.at(at))});
  return out;
}

}  // namespace

void leave_out_repeats(LongSeries& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults) {
  const std::vector<Stretch> parts = stretches({}, rate, {});
  auto missing = leaps_in(rate, rate, parts, LeapOf::kOneValue, time_s, faults);
  const std::vector<Stretch> stuck = stuck_runs(rate, parts);
  if (!stuck.empty()) faults.push_back({"stuck", in_words(stuck, time_s)});
  for (const Stretch& each : stuck) missing.push_back({each, std::nan("")});
  if (std::optional<LongSeries> cleaned = with(rate, std::move(missing))) rate = *std::move(cleaned);
}

std::optional<LongSeries> without_leaps(const SeriesView& rate, const SeriesView& error,
                                        std::span<const Stretch> parts, const TimeOfSample& time_s,
                                        std::vector<ValueFault>& faults) {
  return with(rate, leaps_in(rate, error, parts, LeapOf::kOneSample, time_s, faults));
}

}  // namespace ifog
