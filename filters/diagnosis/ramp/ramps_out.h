// SPDX-License-Identifier: Apache-2.0
// Removes the effect of feedback ramps, logged or reconstructed, from records.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/ramp/ramp.h"

namespace ifog {

struct WithoutRamps {
  std::vector<FoundEffect> ramps;
  std::vector<Record> records;  // without wrapping channels and without what the ramps explain
  std::vector<Samples> rates;   // corrected rates, if a ramp was found
  std::string remark;           // about lines that may come from a ramp that was not logged, or empty
};

// A wrapping counter is not an environment channel: its value or slope would remove rotation. It may explain
// the rate only as a ramp's angle and is removed from the channels in any case. If no counter explains the
// rate, rebuild_ramp() searches for a ramp that was not logged.
WithoutRamps take_out_ramps(const std::vector<Record>& records, double significance);

// Feedback ramp that was not logged. k comes from its comb in the rate, the table is fitted over the measured
// angle, and the correction is computed by the online code.
struct RebuiltRamp {
  std::optional<RampFit> fit;  // effect "rebuilt_ramp"
  std::string remark;          // if lines may come from a ramp but are not corrected
};

// No fit if fixed frequencies explain the harmonics equally well, near zero rate, or if the p-value exceeds
// `significance`.
RebuiltRamp rebuild_ramp(const std::vector<Record>& records, double significance);

}  // namespace ifog
