// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/ramp/ramps_out.h"

#include <algorithm>

#include "filters/diagnosis/ramp/rebuilt_ramp.h"
#include "filters/diagnosis/record/known_columns.h"

namespace ifog {

WithoutRamps take_out_ramps(const std::vector<Record>& records, double significance) {
  WithoutRamps parts;
  parts.records = records;
  if (records.empty()) return parts;
  for (const RecordChannel& channel : records.front().channels) {
    const auto wraps = [&](const Record& record) {
      const std::span<const double> values = values_of(record, channel.name);
      return *known_or(record.known.get(), {"wraps", values}, [&] { return wrap_period(values) > 0.0; });
    };
    if (!std::any_of(records.begin(), records.end(), wraps)) continue;
    for (Record& record : parts.records) {
      std::erase_if(record.channels, [&](const RecordChannel& other) { return other.name == channel.name; });
    }
    if (auto ramp = fit_ramp(records, channel.name, significance)) parts.ramps.push_back(std::move(*ramp));
  }
  if (parts.ramps.empty()) {
    RebuiltRamp rebuilt = rebuild_ramp(parts.records, significance);
    if (rebuilt.fit) parts.ramps.push_back(std::move(*rebuilt.fit));
    parts.remark = std::move(rebuilt.remark);
  }
  if (parts.ramps.empty()) return parts;
  for (std::size_t r = 0; r < records.size(); ++r) {
    Samples rate(records[r].rate_radps.begin(), records[r].rate_radps.end());
    for (const RampFit& ramp : parts.ramps) {
      for (std::size_t i = 0; i < rate.size(); ++i) rate[i] -= ramp.correction[r][i];
    }
    parts.rates.push_back(std::move(rate));
  }
  for (std::size_t r = 0; r < records.size(); ++r) parts.records[r].rate_radps = parts.rates[r];
  return parts;
}

}  // namespace ifog
