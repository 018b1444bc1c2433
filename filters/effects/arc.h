// SPDX-License-Identifier: Apache-2.0
// An angle of which the fit saw a part of the circle: what repeats with it is extrapolated within that arc, whatever
// the wraps, and is held at its nearer end elsewhere, for the rest of the circle was a guess.
#pragma once

#include <cmath>
#include <numbers>
#include <string>

#include "filters/effects/form.h"
#include "filters/effects/meaning.h"
#include "filters/model_file/model.h"

namespace ifog {

[[nodiscard]] inline bool is_of_angle(Form form) noexcept {
  return form == Form::kCosine || form == Form::kSine;
}

// What the channel's wraps are: the period of a harmonic is a whole part of it.
[[nodiscard]] inline double turn_of(const std::string& channel, double period) {
  const std::string unit = unit_of(channel);
  const double turn = unit == "deg" ? 360.0 : unit == "turns" ? 1.0 : 2.0 * std::numbers::pi;
  const double times = turn / period;
  return std::abs(times - std::round(times)) < 1e-6 * times ? turn : period;
}

// As many turns away as brings the angle nearest to the middle of the arc. One without ends is all angles.
[[nodiscard]] inline double beside_arc(double angle, const ChannelRange& arc, double turn) noexcept {
  if (!(turn > 0.0) || !std::isfinite(arc.high - arc.low)) return angle;
  const double middle = 0.5 * (arc.low + arc.high);
  return angle - turn * std::round((angle - middle) / turn);
}

}  // namespace ifog
