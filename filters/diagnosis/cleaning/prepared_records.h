// SPDX-License-Identifier: Apache-2.0
// Captures as every diagnosis and measurement takes them: behind what all axes have in common
// (prepared_channels.h), knocks of the rate left out, a late reference shifted, derived channels beside,
// turns left out, the part to fit cut, ramps taken out. Each step's records show columns that the step before
// owns, so all of it stays together.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/channels/derived_channels.h"
#include "filters/diagnosis/cleaning/channel_faults.h"
#include "filters/diagnosis/cleaning/other_axes.h"
#include "filters/diagnosis/cleaning/prepared_channels.h"
#include "filters/diagnosis/cleaning/reference_delay.h"
#include "filters/diagnosis/cleaning/turned.h"
#include "filters/diagnosis/ramp/ramps_out.h"
#include "filters/diagnosis/record/fitted_part.h"

namespace ifog {

class PreparedRecords {
 public:
  // captures: their arrays outlive this. share: of each, that is fitted. significance: of a ramp. channels:
  // of the same captures and share, outlives this; null: made here. Throws std::invalid_argument as
  // check_columns() and without_turns() do.
  explicit PreparedRecords(const std::vector<Record>& captures, const TimeShare& share = {},
                           double significance = 0.01, const PreparedChannels* channels = nullptr);
  PreparedRecords(const PreparedRecords&) = delete;
  PreparedRecords& operator=(const PreparedRecords&) = delete;

  [[nodiscard]] const std::vector<Record>& whole() const { return resting_.records; }
  [[nodiscard]] const std::vector<Record>& fitted() const { return fitted_; }
  [[nodiscard]] const WithoutRamps& without_ramps() const { return without_; }  // of what is fitted
  // As whole(), with what was logged before its faults were repaired; null where there were none.
  [[nodiscard]] const std::vector<Record>* as_logged() const;
  [[nodiscard]] const std::vector<ReferenceDelay>& delays() const { return aligned_.delays; }
  [[nodiscard]] std::vector<std::string> remarks() const;  // in the order of the steps

 private:
  std::optional<PreparedChannels> own_;
  const PreparedChannels& channels_;
  std::vector<Record> logged_;  // none where nothing was repaired
  RepairedRecords quiet_;
  AlignedRecords aligned_;
  AlongAxes derived_;
  WithoutTurns resting_;
  std::vector<Record> fitted_;
  WithoutRamps without_;
};

}  // namespace ifog
