// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/steps.h"

#include <cmath>

#include "drivers/row_times/sample_clock.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/units/told_time.h"

namespace ifog {
namespace {

constexpr std::size_t kStampsApart = 16;
constexpr double kOwnLengths = 4.0;

// A late stamp lengthens one step and shortens the next, so sums of steps scatter like one step. For steps of
// different lengths the sum's variance is the sum.
bool keeps_a_beat(std::span<const double> time_s, const SampleClock& clock) {
  const double period = clock.period_s;
  double one = 0.0, many = 0.0;
  for (std::size_t i = kStampsApart; i < time_s.size(); i += kStampsApart) {
    const double step = time_s[i] - time_s[i - 1] - period;
    const double sum = time_s[i] - time_s[i - kStampsApart] - static_cast<double>(kStampsApart) * period;
    if (std::abs(sum) > 2.0 * period) continue;  // a gap
    one += step * step;
    many += sum * sum;
  }
  return many < kOwnLengths * one;
}

std::string in_words(const Record& record, const SampleClock& clock) {
  return record.name + formatted(
                           ": the time stamps are up to %.3g ms off an even clock of %.6g Hz, so samples "
                           "are placed by that clock, which restarts behind each hole",
                           1e3 * clock.worst_jitter_s, 1.0 / clock.period_s);
}

}  // namespace

OwnedRecords with_even_stamps(OwnedRecords given) {
  for (Record& record : given.records) {
    const SampleClock clock = sample_clock(record.time_s);
    if (!clock.scatters() || clock.period_s > kSlowest_s || !keeps_a_beat(record.time_s, clock)) continue;
    RowTimes times(record.time_s, clock);
    Samples& even = given.columns.emplace_back(record.time_s.size());
    for (std::size_t i = 0; i < even.size(); ++i)
      even[i] = record.time_s.front() + times.next(record.time_s[i]);
    given.remarks.push_back(in_words(record, clock));
    record.time_s = even;
  }
  return given;
}

}  // namespace ifog
