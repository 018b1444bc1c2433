// SPDX-License-Identifier: Apache-2.0
// Extra variance of axes that are not measured. The filter's common variance falls with every measured axis.
#pragma once

#include <algorithm>
#include <cstddef>

#include "filters/estimator/sample.h"

namespace ifog {

class Unmeasured {
 public:
  // Adds one sample. rate, variance, gain: of the filter after it; grown: increase of each axis's variance by
  // its walk; started: axes that have ever been measured.
  void take(const Sample& now, const Lanes& rate, const Lanes& variance, double gain, const Lanes& grown,
            std::uint32_t started) noexcept {
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      double& more = more_[i];
      if ((now.valid >> a & 1U) != 0) {
        if (more == 0.0) continue;
        // The error is at most the distance from the measurement and its noise.
        const double apart = now.rate[i] - rate[i];
        more = std::min(more * (1.0 - gain) * (1.0 - gain), apart * apart + now.scale[i]);
        if (more < 1e-3 * variance[i]) more = 0.0;
      } else if ((started >> a & 1U) != 0) {
        more = std::max(0.0, more + last_[i] + grown[i] - variance[i]);
      }
    }
    last_ = variance;
  }
  [[nodiscard]] const Lanes& more() const noexcept { return more_; }

 private:
  Lanes more_ = Lanes::Zero(), last_ = Lanes::Zero();
};

}  // namespace ifog
