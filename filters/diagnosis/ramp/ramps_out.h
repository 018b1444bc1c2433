// SPDX-License-Identifier: Apache-2.0
// Records without what their closed loops' feedback ramps make of them, logged or rebuilt.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/ramp/ramp.h"

namespace ifog {

struct WithoutRamps {
  std::vector<RampFit> ramps;
  std::vector<Record> records;  // without channels that wrap, and less what the ramps explain
  std::vector<Samples> rates;   // what their rates point to, when a ramp was found
  std::string remark;           // of lines that one that was not logged may make; empty: none
};

// A counter that wraps is no environment: as a function of its value or slope it would take rotation away. So
// it may explain the rate as a ramp's angle or not at all, and goes from the channels either way. Where none
// does explain it, a ramp that was not logged is looked for: its phase would follow the angle turned
// (rebuild_ramp() below).
WithoutRamps take_out_ramps(const std::vector<Record>& records, double significance);

// A feedback ramp that was not logged: its k found by the comb it leaves in the rate, its table fitted over
// the angle that the sensor has measured, its correction made by the code that runs online.
struct RebuiltRamp {
  std::optional<RampFit> fit;  // effect "rebuilt_ramp"
  std::string remark;          // where lines are found that may be a ramp's and are not corrected
};

// Nothing is found where the harmonics would do as well at fixed frequencies or near zero rate, or where by chance
// a comb would do as well more often than `significance`.
RebuiltRamp rebuild_ramp(const std::vector<Record>& records, double significance);

}  // namespace ifog
