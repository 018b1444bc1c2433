// SPDX-License-Identifier: Apache-2.0
// Of a device's running angle: whether the way between two values of it, with nothing in between, is known.
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

// Over a silence whose length is not decided: that the counted time is too short for the turn at about the
// rate before. One that this explains hides none of more.
inline bool hides_more(double rate_radps, double rate_before_radps) noexcept {
  constexpr double kShare = 0.1, kLittle_radps = 1e-3;
  return std::abs(rate_radps - rate_before_radps) > kShare * std::abs(rate_before_radps) + kLittle_radps;
}

}  // namespace ifog
