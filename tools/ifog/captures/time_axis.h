// SPDX-License-Identifier: Apache-2.0
// What stands below the time axis of a picture, on which large times are counted as in the capture's columns.
#pragma once

#include <string>

#include "drivers/capture/time_stamps.h"
#include "filters/units/told_time.h"

namespace ifog::tools {

// "time (min)", "time since 1700000000.123457 s (min)"
[[nodiscard]] inline std::string time_axis_label(const TimeOrigin& origin, const std::string& unit) {
  return "time " + (origin == TimeOrigin{} ? "" : "since " + told_time(origin.told(0.0)) + " s ") + "(" +
         unit + ")";
}

}  // namespace ifog::tools
