// SPDX-License-Identifier: Apache-2.0
// Preparation of captures, common to diagnosis and measurement: even stamps, unwrapped angles, repaired
// channels, differences of channels, rate without faults, aligned reference, other axes, no turns, the part
// to fit, ramps subtracted.
#pragma once

#include <vector>

#include "filters/diagnosis/ramp/ramps_out.h"
#include "filters/diagnosis/record/fitted_part.h"
#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

struct PreparedRecords {
  // The captures' arrays must outlive this. share: part of each that is fitted. significance: of a ramp.
  // Throws std::invalid_argument as check_columns() and without_turns() do.
  explicit PreparedRecords(const std::vector<Record>& captures, const TimeShare& share = {},
                           double significance = 0.01);

  OwnedRecords whole;
  std::vector<Record> fitted;
  WithoutRamps without_ramps;  // from `fitted`
};

}  // namespace ifog
