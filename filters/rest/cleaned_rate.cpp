// SPDX-License-Identifier: Apache-2.0
#include "filters/rest/cleaned_rate.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <string>
#include <utility>

#include "filters/allan/runs.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

// Equal samples in a row: where repeats are rare, and where up to half of the samples repeat.
constexpr std::size_t kStuck = 8, kHeld = 64;
constexpr std::size_t kMostHeld = 4096;  // of such runs in a record

// Empty if repeated values are normal in this record.
std::vector<Stretch> stuck_runs(std::span<const double> rate, std::span<const Stretch> parts) {
  const std::size_t held = std::max(kHeld, rate.size() / kMostHeld);
  std::vector<Stretch> stuck;
  Repeats repeats;
  std::size_t others = 0, changes = 0;  // samples of shorter runs than `held`
  for_each_run(rate, parts, [&](const Run& run) {
    repeats.add(run);
    if (run.length >= kStuck) stuck.push_back({run.begin, run.begin + run.length});
    if (run.length < held) others += run.length, ++changes;
  });
  if (repeats.runs <= 16 || 2 * changes < others) return {};
  if (!repeats.are_rare()) std::erase_if(stuck, [&](const Stretch& run) { return run.size() < held; });
  return stuck;
}

double largest(std::span<const double> rate) {
  double most = 0.0;
  for (const double value : rate)
    if (std::abs(value) > most) most = std::abs(value);
  return most;
}

std::string in_words(const std::vector<Stretch>& stuck, std::span<const double> rate,
                     const TimeOfSample& time_s) {
  const std::size_t longest = std::ranges::max_element(stuck, {}, &Stretch::size)->size();
  const double most = largest(rate);
  const bool full_scale =
      std::ranges::any_of(stuck, [&](const Stretch& each) { return std::abs(rate[each.begin]) == most; });
  return "stands still for up to " + std::to_string(longest) + " samples, " + std::to_string(stuck.size()) +
         (stuck.size() == 1 ? " time" : " times") + ", first at " + told_time(time_s(stuck.front().begin)) +
         " s: " +
         (full_scale ? "at its largest value, where the sensor or its number format is at full scale"
                     : "the sensor or the logger repeated a value") +
         ", not used";
}

// Interleaved sensors differ by their biases throughout: the scatter of every second, third or fourth sample about its
// mean is less than half of the total scatter. A dither does not stay in step with the samples for a whole record.
void find_interleaved(const Samples& rate, std::vector<ValueFault>& faults) {
  constexpr std::size_t kMostSamples = 1'000'000, kFewSamples = 256;
  std::vector<double> values;
  for (const double value : rate)
    if (!std::isnan(value) && values.size() < kMostSamples) values.push_back(value);
  if (values.size() < kFewSamples) return;
  const auto variance = [&](std::size_t first, std::size_t apart) {
    double count = 0.0, sum = 0.0, squares = 0.0;
    for (std::size_t i = first; i < values.size(); i += apart) {
      const double value = values[i] - values[0];
      count += 1.0, sum += value, squares += value * value;
    }
    return squares / count - sum / count * (sum / count);
  };
  const double all = variance(0, 1);
  for (std::size_t sensors = 2; sensors <= 4; ++sensors) {
    double within = 0.0;
    for (std::size_t first = 0; first < sensors; ++first)
      within += variance(first, sensors) / static_cast<double>(sensors);
    if (within > 0.25 * all || all == 0.0) continue;
    faults.push_back({"interleaved", std::to_string(sensors) +
                                         " sensors seem to stand in turn, each with a bias of its "
                                         "own; --only COLUMN=VALUE reads one of them"});
    return;
  }
}

// leaps: in order.
std::optional<Samples> without(std::span<const double> rate, const std::vector<Glitches::Leap>& leaps) {
  if (leaps.empty()) return std::nullopt;
  Samples out(rate);
  for (const auto& [samples, value] : leaps)
    std::fill(out.begin() + samples.begin, out.begin() + samples.end, value);
  return out;
}

}  // namespace

void leave_out_placeholders(Samples& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults) {
  auto cleaned = without_leaps(rate, rate, stretches({}, rate, {}), time_s, faults, LeapOf::kOneValue);
  if (cleaned) rate = *std::move(cleaned);
  find_interleaved(rate, faults);
}

namespace {

void leave_out(const std::vector<Stretch>& stuck, Samples& rate, const TimeOfSample& time_s,
               std::vector<ValueFault>& faults) {
  if (stuck.empty()) return;
  faults.push_back({"stuck", in_words(stuck, rate, time_s)});
  std::vector<Glitches::Leap> missing;
  for (const Stretch& each : stuck) missing.push_back({each, std::nan("")});
  rate = *without(rate, missing);
}

}  // namespace

void leave_out_full_scale(Samples& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults) {
  leave_out_placeholders(rate, time_s, faults);
  std::vector<Stretch> stuck = stuck_runs(rate, stretches({}, rate, {}));
  std::erase_if(
      stuck, [&, most = largest(rate)](const Stretch& each) { return std::abs(rate[each.begin]) != most; });
  leave_out(stuck, rate, time_s, faults);
}

void leave_out_repeats(Samples& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults) {
  leave_out_placeholders(rate, time_s, faults);
  leave_out(stuck_runs(rate, stretches({}, rate, {})), rate, time_s, faults);
}

std::optional<Samples> without_leaps(std::span<const double> rate, std::span<const double> error,
                                     std::span<const Stretch> parts, const TimeOfSample& time_s,
                                     std::vector<ValueFault>& faults, LeapOf of) {
  Glitches leaps = find_glitches(error, parts, of);
  if (leaps.count > 0) faults.push_back({"leaps", in_words(leaps, time_s)});
  for (auto& [samples, value] : leaps.few) value += rate[samples.begin] - error[samples.begin];
  return without(rate, leaps.few);
}

}  // namespace ifog
