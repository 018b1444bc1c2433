// SPDX-License-Identifier: Apache-2.0
// Tells if the turn between two successive values of a device's running angle is unambiguous.
#pragma once

#include <cmath>

namespace ifog {

// gap_s: duration of missing samples. Ambiguous if the angle could have changed by half a turn at twice the
// previous rate plus 0.5 rad/s (a vehicle that starts to turn).
inline bool turn_is_known(double rate_before_radps, double gap_s, double wrap_rad) noexcept {
  constexpr double kMightBegin_radps = 0.5;
  const double fastest = 2.0 * std::abs(rate_before_radps) + kMightBegin_radps;
  return !(wrap_rad > 0.0) || fastest * gap_s < 0.5 * wrap_rad;
}

}  // namespace ifog
