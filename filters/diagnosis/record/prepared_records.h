// SPDX-License-Identifier: Apache-2.0
// Captures as every diagnosis and measurement takes them: stamps that scatter set even, parted at long holes,
// angles without their wraps, faults of logging repaired, a late reference shifted, derived channels beside,
// turns left out, the part to fit cut, ramps taken out. Each step's records show columns that the step before
// owns, so all of it stays together.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/channel_faults.h"
#include "filters/diagnosis/record/derived_channels.h"
#include "filters/diagnosis/record/even_stamps.h"
#include "filters/diagnosis/record/fitted_part.h"
#include "filters/diagnosis/record/long_holes.h"
#include "filters/diagnosis/record/ramps_out.h"
#include "filters/diagnosis/record/reference_delay.h"
#include "filters/diagnosis/record/turned.h"

namespace ifog {

class PreparedRecords {
 public:
  // captures: their arrays outlive this. share: of each, that is fitted. significance: of a ramp. Throws
  // std::invalid_argument as check_columns() and without_turns() do.
  explicit PreparedRecords(const std::vector<Record>& captures, const TimeShare& share = {},
                           double significance = 0.01);
  PreparedRecords(const PreparedRecords&) = delete;
  PreparedRecords& operator=(const PreparedRecords&) = delete;

  [[nodiscard]] const std::vector<Record>& whole() const { return resting_.records; }
  [[nodiscard]] const std::vector<Record>& fitted() const { return fitted_; }
  [[nodiscard]] const WithoutRamps& without_ramps() const { return without_; }  // of what is fitted
  // As whole(), with channels before their faults were repaired; null where there were none.
  [[nodiscard]] const std::vector<Record>* as_logged() const;
  [[nodiscard]] const std::vector<ReferenceDelay>& delays() const { return aligned_.delays; }
  [[nodiscard]] const std::vector<StuckStretch>& stuck() const { return repaired_.stuck; }
  [[nodiscard]] std::vector<std::string> remarks() const;  // in the order of the steps

 private:
  TimedRecords timed_;
  PartedRecords parted_;
  DerivedRecords unwrapped_;
  RepairedRecords repaired_;
  AlignedRecords aligned_;
  DerivedRecords derived_;
  WithoutTurns resting_;
  std::vector<Record> fitted_;
  WithoutRamps without_;
};

}  // namespace ifog
