// SPDX-License-Identifier: Apache-2.0
// Angle of which the fit saw only a part of the circle. A periodic effect is extrapolated within that arc,
// modulo the turn; elsewhere it keeps its value at the nearer end.
#pragma once

#include <cmath>
#include <string>

#include "filters/effects/meaning.h"
#include "filters/model_file/model.h"

namespace ifog {

// Modulus of the channel's wraps; the period of a harmonic is a fraction of it.
[[nodiscard]] inline double turn_of(const std::string& channel, double period) {
  const double turn = turn_by_unit(channel), times = turn / period;
  return std::abs(times - std::round(times)) < 1e-6 * times ? turn : period;
}

// Adds whole turns so that the angle is nearest to the middle of the arc. Without limits the arc is the whole
// circle.
[[nodiscard]] inline double nearest_on_arc(double angle, const ChannelRange& arc, double turn) noexcept {
  if (!(turn > 0.0) || !std::isfinite(arc.high - arc.low)) return angle;
  const double middle = 0.5 * (arc.low + arc.high);
  return angle - turn * std::round((angle - middle) / turn);
}

}  // namespace ifog
