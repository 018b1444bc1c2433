// SPDX-License-Identifier: Apache-2.0
// A rate as people read it: a decimal, and of a slow one as many as it takes to see it.
#pragma once

#include <string>

#include "filters/units/told_time.h"

namespace ifog::tools {

inline std::string in_hertz(double rate_hz) {
  return formatted(rate_hz > 0.0 && rate_hz < 1.0 ? "%.2g Hz" : "%.1f Hz", rate_hz);
}

}  // namespace ifog::tools
