// SPDX-License-Identifier: Apache-2.0
// Extrapolation of a model outside its fitted range.
//
// Polynomial forms are extrapolated over one more width of the range: linear ones as they are, higher powers
// by their tangent (curve_reach.h). Beyond that, and for lookup tables, the value at the edge is held.
// Effects of channels that sense motion fade out instead, because a fit at rest is not valid in motion.
#pragma once

#include <algorithm>
#include <cmath>

#include "filters/model_file/model.h"

namespace ifog {

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

}  // namespace ifog
