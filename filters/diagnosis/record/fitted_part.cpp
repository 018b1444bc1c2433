// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/fitted_part.h"

#include <algorithm>

#include "filters/rest/rest.h"

namespace ifog {

Stretch samples_in(const Record& record, const TimeShare& share) {
  const double start = record.time_s.front();
  const double span = record.time_s.back() - start;
  const auto at = [&](double fraction) {
    const auto place = std::ranges::lower_bound(record.time_s, start + fraction * span);
    return static_cast<std::size_t>(place - record.time_s.begin());
  };
  return {at(share.from), share.to >= 1.0 ? record.time_s.size() : at(share.to)};
}

Record part_of(const Record& record, const Stretch& samples) {
  Record part = record;
  part.time_s = record.time_s.subspan(samples.begin, samples.size());
  part.since_power_up_s += part.time_s.front() - record.time_s.front();
  part.rate_radps = record.rate_radps.subspan(samples.begin, samples.size());
  if (!record.reference_radps.empty())
    part.reference_radps = record.reference_radps.subspan(samples.begin, samples.size());
  for (RecordChannel& channel : part.channels)
    channel.values = channel.values.subspan(samples.begin, samples.size());
  for (RecordChannel& axis : part.other_axes)
    axis.values = axis.values.subspan(samples.begin, samples.size());
  for (std::span<const double>& reference : part.other_references)
    if (!reference.empty()) reference = reference.subspan(samples.begin, samples.size());
  part.at_rest = common(record.at_rest, {&samples, 1});
  for (Stretch& stretch : part.at_rest)
    stretch = {stretch.begin - samples.begin, stretch.end - samples.begin};
  return part;
}

std::vector<Record> fitted_parts(const std::vector<Record>& records, const TimeShare& share) {
  std::vector<Record> parts;
  parts.reserve(records.size());
  for (const Record& record : records) parts.push_back(part_of(record, samples_in(record, share)));
  return parts;
}

}  // namespace ifog
