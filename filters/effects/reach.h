// SPDX-License-Identifier: Apache-2.0
// Extrapolation of a model outside its fitted range.
//
// Polynomial forms are extrapolated over one more width of the range: linear ones as they are, higher powers
// by their tangent (kCurveReach). Beyond that, and for lookup tables, the value at the edge is held.
// Effects of channels that sense motion fade out instead, because a fit at rest is not valid in motion. A periodic
// effect of an angle of which the fit saw only a part of the circle is extrapolated within that arc, modulo the turn;
// elsewhere it keeps its value at the nearer end.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>
#include <string_view>

#include "filters/effects/meaning.h"
#include "filters/model_file/model.h"

namespace ifog {

// Powers above one are extrapolated by their tangent, or by the power itself if its curvature is well known. This
// parameter of the effect gives how far, in the channel's unit of that power; then the tangent continues.
inline constexpr std::string_view kCurveReach = "curve_reach";

struct Reach {
  double edge = 0.0;    // the value limited to the range
  double value = 0.0;   // the value limited to the extrapolated range
  double beyond = 0.0;  // the channel minus `value`
  double span = 0.0;    // width of the range
  double weight = 1.0;  // of the correction; fades to 0 one span beyond the range

  [[nodiscard]] bool outside() const noexcept { return value != edge || beyond != 0.0; }
  [[nodiscard]] double past_the_edge() const noexcept { return value - edge; }
};

[[nodiscard]] inline Reach reach_of(double value, const ChannelRange& range) noexcept {
  Reach reach;
  reach.edge = std::clamp(value, range.low, range.high);
  reach.span = range.high - range.low;
  // No extrapolation of a channel that was constant in the fit; a channel without a range has no edge.
  const double more = std::isfinite(reach.span) ? reach.span : 0.0;
  reach.value = std::clamp(value, reach.edge - more, reach.edge + more);
  reach.beyond = value - reach.value;
  if (range.fades && value != reach.edge)
    reach.weight = more > 0.0 ? std::max(0.0, 1.0 - std::abs(value - reach.edge) / more) : 0.0;
  return reach;
}

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
