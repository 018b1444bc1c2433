// SPDX-License-Identifier: Apache-2.0
// Extra variance of axes that are not measured. The filter's common variance falls with every measured axis.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "filters/estimator/sample.h"

namespace ifog {

class Unmeasured {
 public:
  // Adds one sample. rate, variance, gain: of the filter after it; grown: increase of each axis's variance by
  // its walk; started: axes that have ever been measured.
  void take(const Sample& now, const Lanes& rate, const Lanes& variance, double gain, const Lanes& grown,
            std::uint32_t started, bool moving) noexcept {
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      double& more = more_[i];
      if ((now.valid >> a & 1U) != 0) {
        others_[a] = rate;
        if (more == 0.0) continue;
        // The error is at most the distance from the measurement and its noise.
        const double apart = now.rate[i] - rate[i];
        more = std::min(more * (1.0 - gain) * (1.0 - gain), apart * apart + now.scale[i]);
        if (more < 1e-3 * variance[i]) more = 0.0;
      } else if ((started >> a & 1U) != 0) {
        more = std::max(0.0, more + last_[i] + grown[i] - variance[i]);
        // A significant rotation about the other axes may also be about this one.
        const Lanes turned = now.mask * (rate - others_[a]).square();
        if (moving)
          more = std::max(more, greatest((turned > kMostSquare * 2.0 * variance).select(turned, 0.0)));
      }
    }
    last_ = variance;
  }
  [[nodiscard]] const Lanes& more() const noexcept { return more_; }

 private:
  Lanes more_ = Lanes::Zero(), last_ = Lanes::Zero();
  std::array<Lanes, kMaxAxes> others_{};  // rates when the axis was last measured
};

}  // namespace ifog
