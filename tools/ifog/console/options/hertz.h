// SPDX-License-Identifier: Apache-2.0
// Formats a rate with one decimal, or with two significant digits below 1 Hz.
#pragma once

#include <string>

#include "filters/units/told_time.h"

namespace ifog::tools {

inline std::string in_hertz(double rate_hz) {
  return formatted(rate_hz > 0.0 && rate_hz < 1.0 ? "%.2g Hz" : "%.1f Hz", rate_hz);
}

}  // namespace ifog::tools
