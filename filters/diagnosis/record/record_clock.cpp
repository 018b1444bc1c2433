// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/record/record_clock.h"

#include <memory>
#include <stdexcept>

#include "filters/effects/compensate_series.h"

namespace ifog {
namespace {

const KnownClock* known(const Record& record) {
  if (!record.clock || record.clock->time_s.data() != record.time_s.data() ||
      record.clock->time_s.size() != record.time_s.size())
    return nullptr;
  return record.clock.get();
}

}  // namespace

SampleClock clock_of(const Record& record) {
  const KnownClock* const clock = known(record);
  return clock != nullptr ? clock->clock : sample_clock(record.time_s);
}

double usual_step_of(const Record& record) {
  const KnownClock* const clock = known(record);
  return clock != nullptr ? clock->usual_step_s : usual_step(record.time_s);
}

void look_at_clock(Record& record) {
  if (known(record) != nullptr) return;
  try {
    record.clock = std::make_shared<const KnownClock>(
        KnownClock{record.time_s, sample_clock(record.time_s), usual_step_of(record)});
  } catch (const std::invalid_argument&) {
    // Without an even clock: whoever asks is told.
  }
}

}  // namespace ifog
