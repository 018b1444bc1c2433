// SPDX-License-Identifier: Apache-2.0
// How far a model is extrapolated outside the range it was fitted on.
//
// Holding a well-known linear effect at the edge leaves the whole of what the channel does beyond it, so
// polynomial forms are extrapolated: linear as they are, higher ones by their tangent (curve_reach.h), for as much again
// as the range is wide. Beyond that, and for what is only known where it was looked up, the value is held.
// What goes with the sensor's motion fades instead: what was fitted while it stood says nothing of a ride.
#pragma once

#include <algorithm>
#include <cmath>

#include "filters/model_file/model.h"

namespace ifog {

struct Reach {
  double edge = 0.0;    // the value, or the nearest one inside the range
  double value = 0.0;   // as far as a polynomial form follows
  double beyond = 0.0;  // the channel less that
  double span = 0.0;    // width of the range
  double weight = 1.0;  // of the correction: of what fades 0 from one span beyond the range on

  [[nodiscard]] bool outside() const noexcept { return value != edge || beyond != 0.0; }
  [[nodiscard]] double past_the_edge() const noexcept { return value - edge; }
};

[[nodiscard]] inline Reach reach_of(double value, const ChannelRange& range) noexcept {
  Reach reach;
  reach.edge = std::clamp(value, range.low, range.high);
  reach.span = range.high - range.low;
  // A channel that did not move in the fit has taught nothing to extrapolate, and one without a range has no
  // edge.
  const double more = std::isfinite(reach.span) ? reach.span : 0.0;
  reach.value = std::clamp(value, reach.edge - more, reach.edge + more);
  reach.beyond = value - reach.value;
  if (range.fades && value != reach.edge)
    reach.weight = more > 0.0 ? std::max(0.0, 1.0 - std::abs(value - reach.edge) / more) : 0.0;
  return reach;
}

}  // namespace ifog
