// SPDX-License-Identifier: Apache-2.0
// Formats a rate with one decimal, or with two significant digits below 1 Hz.
#pragma once

#include <fmt/core.h>

#include <string>

namespace ifog::tools {

inline std::string in_hertz(double rate_hz) {
  return rate_hz > 0.0 && rate_hz < 1.0 ? fmt::format("{:.2g} Hz", rate_hz)
                                        : fmt::format("{:.1f} Hz", rate_hz);
}

}  // namespace ifog::tools
