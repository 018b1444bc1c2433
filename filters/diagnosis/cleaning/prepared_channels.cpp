// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/prepared_channels.h"

#include <memory>
#include <utility>

#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/known_columns.h"
#include "filters/diagnosis/record/record_clock.h"

namespace ifog {
namespace {

std::vector<Record> checked(std::vector<Record> captures) {
  check_columns(captures);
  for (Record& record : captures) look_at_clock(record);
  return captures;
}

}  // namespace

// An angle's wraps are no faults.
PreparedChannels::PreparedChannels(const std::vector<Record>& captures, unsigned threads)
    : timed_(with_even_stamps(checked(captures))),
      unwrapped_(with_unwrapped_angles(timed_.records)),
      repaired_(repair_channels(unwrapped_.records, threads)),
      whole_(with_differences(repaired_.records)) {
  const auto known = std::make_shared<KnownColumns>();
  for (Record& record : whole_.records) {
    look_at_clock(record);
    record.known = known;
    known->add(record.time_s);
    known->add(record.rate_radps);
    for (const RecordChannel& axis : record.other_axes) known->add(axis.values);
    for (const RecordChannel& channel : record.channels) known->add(channel.values);
  }
}

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
    record.clock = channels[i].clock;
    record.known = channels[i].known;
    records.push_back(std::move(record));
  }
  return records;
}

std::vector<std::string> PreparedChannels::remarks_of_times() const {
  std::vector<std::string> all = timed_.remarks;
  all.insert(all.end(), unwrapped_.remarks.begin(), unwrapped_.remarks.end());
  return all;
}

}  // namespace ifog
