// SPDX-License-Identifier: Apache-2.0
// Captures as every diagnosis and measurement takes them: stamps that scatter set even, angles without their
// wraps, channels' faults repaired, differences of channels added, faults of the rate out, a late
// reference shifted, the other axes added, turns dropped, the part to fit cut, ramps subtracted.
#pragma once

#include <vector>

#include "filters/diagnosis/ramp/ramps_out.h"
#include "filters/diagnosis/record/fitted_part.h"
#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

struct PreparedRecords {
  // captures: their arrays outlive this. share: of each, that is fitted. significance: of a ramp. Throws
  // std::invalid_argument as check_columns() and without_turns() do.
  explicit PreparedRecords(const std::vector<Record>& captures, const TimeShare& share = {},
                           double significance = 0.01);

  OwnedRecords whole;
  std::vector<Record> fitted;
  WithoutRamps without_ramps;  // of what is fitted
};

}  // namespace ifog
