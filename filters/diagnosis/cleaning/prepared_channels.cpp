// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/prepared_channels.h"

#include <cmath>
#include <utility>

#include "filters/allan/row_times.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/words.h"

namespace ifog {
namespace {

const std::vector<Record>& checked(const std::vector<Record>& captures) {
  check_columns(captures);
  return captures;
}

}  // namespace

// An angle's wraps are no faults.
PreparedChannels::PreparedChannels(const std::vector<Record>& captures, unsigned threads)
    : timed_(with_even_stamps(checked(captures))),
      unwrapped_(with_unwrapped_angles(timed_.records)),
      repaired_(repair_channels(unwrapped_.records, threads)),
      whole_(with_differences(repaired_.records)) {}

std::vector<Record> PreparedChannels::of_axis(const std::vector<Record>& captures) const {
  return with_rates_of(captures, whole_.records);
}

std::vector<Record> PreparedChannels::as_logged(const std::vector<Record>& captures) const {
  return with_rates_of(captures, unwrapped_.records);
}

std::vector<Record> PreparedChannels::with_rates_of(const std::vector<Record>& captures,
                                                    const std::vector<Record>& channels) const {
  check_columns(captures);
  std::vector<Record> records;
  records.reserve(channels.size());
  for (std::size_t i = 0; i < channels.size(); ++i) {
    Record record = captures[i];
    record.name = channels[i].name;
    record.time_s = channels[i].time_s;
    record.channels = channels[i].channels;
    records.push_back(std::move(record));
  }
  return records;
}

std::vector<std::string> PreparedChannels::remarks_of_times() const {
  std::vector<std::string> all = timed_.remarks;
  all.insert(all.end(), unwrapped_.remarks.begin(), unwrapped_.remarks.end());
  return all;
}

namespace {

constexpr double kLongestPeriod_s = 1.0;  // beyond, rows are averages of their own
constexpr std::size_t kSteps = 16;
constexpr double kOwnLengths = 4.0;

// What one late stamp adds to a step it takes from the next, so sums of steps scatter as one does; of steps
// that are of different lengths the sum's variance is the sum.
bool keeps_a_beat(std::span<const double> time_s, const SampleClock& clock) {
  const double period = clock.period_s;
  double one = 0.0, many = 0.0;
  for (std::size_t i = kSteps; i < time_s.size(); i += kSteps) {
    const double step = time_s[i] - time_s[i - 1] - period;
    const double sum = time_s[i] - time_s[i - kSteps] - static_cast<double>(kSteps) * period;
    if (std::abs(sum) > 2.0 * period) continue;  // a hole
    one += step * step;
    many += sum * sum;
  }
  return many < kOwnLengths * one;
}

std::string in_words(const Record& record, const SampleClock& clock) {
  return record.name + printed(
                           ": the time stamps are up to %.3g ms off an even clock of %.6g Hz, so samples "
                           "were taken by that clock, again behind each hole",
                           1e3 * clock.worst_jitter_s, 1.0 / clock.period_s);
}

}  // namespace

TimedRecords with_even_stamps(const std::vector<Record>& records) {
  TimedRecords timed{records, {}, {}};
  timed.times.resize(records.size());
  for (std::size_t r = 0; r < records.size(); ++r) {
    Record& record = timed.records[r];
    const SampleClock clock = sample_clock(record.time_s);
    if (!clock.scatters() || clock.period_s > kLongestPeriod_s || !keeps_a_beat(record.time_s, clock))
      continue;
    RowTimes times(record.time_s, clock);
    Samples& even = timed.times[r];
    even.resize(record.time_s.size());
    for (std::size_t i = 0; i < even.size(); ++i)
      even[i] = record.time_s.front() + times.next(record.time_s[i]);
    timed.remarks.push_back(in_words(record, clock));
    record.time_s = even;
  }
  return timed;
}

}  // namespace ifog
