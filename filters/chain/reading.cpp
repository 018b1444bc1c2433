// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/reading.h"

#include <cstddef>

namespace ifog {

void merge(Increment& into, const Increment& later) noexcept {
  Increment sum = later;
  sum.dt_s = into.dt_s + later.dt_s;
  sum.samples = into.samples + later.samples;
  sum.flags = into.flags | later.flags | kMerged;
  sum.status = into.status | later.status;
  sum.valid_axes = into.valid_axes | later.valid_axes;
  sum.stuck_axes = into.stuck_axes | later.stuck_axes;
  for (std::size_t i = 0; i < kMaxAxes; ++i) {
    sum.delta_theta_rad[i] = into.delta_theta_rad[i] + later.delta_theta_rad[i];
    sum.covered_s[i] = into.covered_s[i] + later.covered_s[i];
    sum.delta_v_mps[i] = into.delta_v_mps[i] + later.delta_v_mps[i];
    sum.moved_s[i] = into.moved_s[i] + later.moved_s[i];
    sum.rate_radps[i] = sum.covered_s[i] > 0.0 ? sum.delta_theta_rad[i] / sum.covered_s[i]
                                               : std::numeric_limits<double>::quiet_NaN();
  }
  into = sum;
}

}  // namespace ifog
