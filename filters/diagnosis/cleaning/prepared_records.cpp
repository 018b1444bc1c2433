// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/cleaning/prepared_records.h"

#include <utility>

#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/diagnosis/cleaning/reference_delay.h"
#include "filters/diagnosis/cleaning/steps.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {
namespace {

// Wraps are removed before faults are searched, and differences are formed of repaired channels.
OwnedRecords cleaned(const std::vector<Record>& captures) {
  check_columns(captures);
  OwnedRecords channels = with_differences(
      repair_channels(with_unwrapped_angles(with_readings_alone(with_even_stamps(captures)))));
  return without_turns(with_other_axes(without_leaping_rates(align_references(std::move(channels)))));
}

}  // namespace

PreparedRecords::PreparedRecords(const std::vector<Record>& captures, const TimeShare& share,
                                 double significance)
    : whole(cleaned(captures)),
      fitted(share.whole() ? whole.records : fitted_parts(whole.records, share)),
      without_ramps(take_out_ramps(fitted, significance)) {}

}  // namespace ifog
