// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/compensated_error.h"

#include <limits>

#include "filters/effects/compensate_series.h"

namespace ifog {

Samples compensated_error(const Record& record, const Model& model) {
  Compensator compensator(model, {""}, std::numeric_limits<double>::infinity(), record.since_power_up_s);
  SeriesToCompensate series{record.time_s, {record.rate_radps}, {}};
  series.channels.reserve(compensator.channels().size());
  for (const std::string& name : compensator.channels()) series.channels.push_back(values_of(record, name));
  Samples error(record.time_s.size());
  compensate_series(compensator, series, [&](std::size_t i, const CompensatorOutput& out) {
    error[i] = out.compensated_radps[0];
    if (!record.reference_radps.empty()) error[i] -= record.reference_radps[i];
  });
  return error;
}

}  // namespace ifog
