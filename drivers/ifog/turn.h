// SPDX-License-Identifier: Apache-2.0
// Of an angle that goes round: whether the way between two values of it, with nothing in between, is known.
#pragma once

#include <cmath>

namespace ifog {

// gap_s: in which samples are missing. It is not where at twice the rate before, and 90 °/s more, as a
// vehicle may begin to turn, the angle could have gone half round.
inline bool turn_is_known(double rate_before_radps, double gap_s, double wrap_rad) noexcept {
  constexpr double kMightBegin_radps = 0.5;
  const double fastest = 2.0 * std::abs(rate_before_radps) + kMightBegin_radps;
  return !(wrap_rad > 0.0) || fastest * gap_s < 0.5 * wrap_rad;
}

}  // namespace ifog
