// SPDX-License-Identifier: Apache-2.0
// Whether the turn between two successive values of a device's running angle is known.
#pragma once

#include <cmath>

namespace ifog {

// gap_s: in which samples are missing. It is unknown where the angle could have gone half way round at twice
// the rate before and 0.5 rad/s more, as a vehicle may begin to turn.
inline bool turn_is_known(double rate_before_radps, double gap_s, double wrap_rad) noexcept {
  constexpr double kMightBegin_radps = 0.5;
  const double fastest = 2.0 * std::abs(rate_before_radps) + kMightBegin_radps;
  return !(wrap_rad > 0.0) || fastest * gap_s < 0.5 * wrap_rad;
}

}  // namespace ifog
