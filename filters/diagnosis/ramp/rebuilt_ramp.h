// SPDX-License-Identifier: Apache-2.0
// A feedback ramp that was not logged: its k found by the comb it leaves in the rate, its table fitted over
// the angle that the sensor has measured, its correction made by the code that runs online.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/ramp/ramp.h"

namespace ifog {

struct RebuiltRamp {
  std::optional<RampFit> fit;  // effect "rebuilt_ramp"
  std::string remark;          // what keeps it from being found, where there is something to say
};

// Nothing is found, and a reason given if there may be one: where the harmonics would do as well at fixed
// frequencies, where the table does not predict the parts held out of its fit, where by chance a comb would
// do as well more often than `significance`.
RebuiltRamp rebuild_ramp(const std::vector<Record>& records, double significance);

}  // namespace ifog
