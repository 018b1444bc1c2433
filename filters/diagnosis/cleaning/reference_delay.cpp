// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/steps.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <list>
#include <optional>
#include <stdexcept>
#include <utility>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/diagnosis/cleaning/cross_delay.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/record/figures.h"
#include "filters/diagnosis/record/fitted_part.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kMostDelaySteps = 1U << 17U;  // steps of the series on which the delay is searched
constexpr double kCertain = 5.0;                    // standard errors: one in a million by chance
constexpr double kLeastSteps = 0.01;                // no stamps are truer

// Of all axes together: one instrument logged the references.
std::optional<ReferenceDelay> delay_of(const Record& record, double period_s) {
  const auto steps = static_cast<std::size_t>((record.time_s.back() - record.time_s.front()) / period_s);
  const std::size_t count = steps / kMostDelaySteps + 1;
  const double step_s = period_s * static_cast<double>(count);
  std::vector<std::array<Samples, 2>> means;
  const auto add = [&](std::span<const double> rate, std::span<const double> reference) {
    if (moves(reference))
      means.push_back({means_over(on_even_grid(record, period_s, rate), count),
                       means_over(on_even_grid(record, period_s, reference), count)});
  };
  add(record.rate_radps, record.reference_radps);
  for (std::size_t a = 0; a < record.other_references.size(); ++a)
    add(record.other_axes[a].values, record.other_references[a]);
  std::vector<SameMotion> axes;
  for (const auto& [rate, reference] : means) axes.push_back({rate, reference});
  const auto longest = std::min(static_cast<std::size_t>(kMostEarly_s / step_s), steps / count / 4);
  const std::optional<CrossDelay> found = cross_delay(axes, longest);
  if (!found || std::abs(found->steps) < std::max(kCertain * found->error, kLeastSteps)) return std::nullopt;
  return ReferenceDelay{record.name, found->steps * step_s, found->error * step_s};
}

// Delay of a reference at the record's start, and by how much it grows: the clocks of two loggers run apart.
struct LateBy {
  double start_s = 0.0, growth = 0.0;
};

// A reference without delay, by row of the record.
Samples moved(const Record& record, double period_s, const LateBy& late_by,
              std::span<const double> reference) {
  const Samples even =
      shifted(on_even_grid(record, period_s, reference), late_by.start_s / period_s, late_by.growth);
  Samples out(record.time_s.size());
  for (std::size_t i = 0; i < out.size(); ++i) {
    const auto k =
        static_cast<std::size_t>(std::floor((record.time_s[i] - record.time_s.front()) / period_s + 0.5));
    out[i] = even[std::min(k, even.size() - 1)];
  }
  return out;
}

// The record with its references moved; columns: their storage.
Record aligned(Record record, double period_s, const LateBy& late_by, std::list<Samples>& columns) {
  const auto move = [&](std::span<const double>& reference) {
    if (!reference.empty()) reference = columns.emplace_back(moved(record, period_s, late_by, reference));
  };
  move(record.reference_radps);
  for (std::span<const double>& other : record.other_references) move(other);
  return record;
}

// Follows a delay that differs between the halves of the record by more than a sample.
LateBy with_growth(const Record& record, double period_s, LateBy late_by) {
  constexpr int kRounds = 4;
  const double half_s = 0.5 * (record.time_s.back() - record.time_s.front());
  for (int round = 0; round < kRounds; ++round) {
    std::list<Samples> columns;
    const Record now = aligned(record, period_s, late_by, columns);
    const auto delay_in = [&](double from, double to) {
      return delay_of(part_of(now, samples_in(now, {from, to})), period_s).value_or(ReferenceDelay{});
    };
    const ReferenceDelay first = delay_in(0.0, 0.5), second = delay_in(0.5, 1.0);
    const double more_s = second.delay_s - first.delay_s;
    const double certain_s = kCertain * std::hypot(first.std_error_s, second.std_error_s);
    if (std::abs(more_s) <= std::max(late_by.growth == 0.0 ? period_s : 0.0, certain_s)) break;
    // The halves' delays are those of their middles.
    late_by.growth += more_s / half_s;
    late_by.start_s += first.delay_s - 0.5 * more_s;
  }
  return late_by;
}

std::string in_words(const ReferenceDelay& delay, const LateBy& late_by, const std::string& name) {
  const double late = delay.delay_s;
  if (late_by.growth != 0.0)
    return name + formatted(
                      ": its clock runs %.4g ppm %s than that of the rate, and it is %.4g s %s at the start: "
                      "shifted",
                      1e6 * std::abs(late_by.growth), late_by.growth > 0.0 ? "faster" : "slower",
                      std::abs(late_by.start_s), late_by.start_s > 0.0 ? "late" : "early");
  return name + formatted(" logged %.4g s %s (+-%.2g): shifted", std::abs(late),
                          late > 0.0 ? "late" : "early, or the rate late", delay.std_error_s);
}

}  // namespace

OwnedRecords align_references(OwnedRecords given) {
  for (Record& record : given.records) {
    if (record.reference_radps.empty()) continue;
    try {
      const double period_s = sample_clock(record.time_s).period_s;
      if (period_s > kSlowest_s) continue;
      const std::optional<ReferenceDelay> found = delay_of(record, period_s);
      const ReferenceDelay delay = found.value_or(ReferenceDelay{record.name, 0.0, 0.0});
      const LateBy late_by = with_growth(record, period_s, {delay.delay_s});
      if (!found && late_by.growth == 0.0) continue;
      record = aligned(record, period_s, late_by, given.columns);
      given.remarks.push_back(in_words(delay, late_by, record.reference_name + given.of_several(record)));
      given.delays.push_back(delay);
    } catch (const std::invalid_argument&) {
      continue;  // no even clock, or too few samples
    }
  }
  return given;
}

}  // namespace ifog
