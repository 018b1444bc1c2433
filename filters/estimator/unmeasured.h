// SPDX-License-Identifier: Apache-2.0
// What an axis is not known by that is not measured while others are: the filter's own variance is of those.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "filters/estimator/sample.h"

namespace ifog {

class Unmeasured {
 public:
  // One sample. rate, variance, gain: as the filter has them after it; grown: by which its variance has before
  // it, of each axis' own walk; started: axes that have ever been measured; predicted: with no axis measured the
  // filter's own variance says enough.
  void take(const Sample& now, const Lanes& rate, const Lanes& variance, double gain, const Lanes& grown,
            std::uint32_t started, bool predicted) noexcept {
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      const auto i = static_cast<Eigen::Index>(a);
      if ((now.valid >> a & 1U) != 0)
        measure(a, gain, variance[i], now.rate[i] - rate[i], now.scale[i]);
      else if (now.valid == 0 && predicted)
        lost_[a].variance += lost_[a].now ? grown[i] : 0.0;
      else if ((started >> a & 1U) != 0)
        miss(a, grown[i], to_axes(rate), to_axes(variance));
    }
  }
  // Variance of the axis, where the filter's is `filters`.
  [[nodiscard]] double variance(std::size_t axis, double filters) const noexcept {
    const Lost& lost = lost_[axis];
    return lost.now ? std::max(filters, lost.variance + lost.moved) : filters + lost.variance;
  }

 private:
  // The axis has no measurement of this sample, another has. rates, variances: of all axes.
  void miss(std::size_t axis, double grown, const Axes& rates, const Axes& variances) noexcept {
    Lost& lost = lost_[axis];
    if (!lost.now) lost = {true, std::max(lost.variance, variances[axis]), 0.0, rates, variances};
    lost.variance += grown;
    // What turns about the other axes, by more than they have walked, may turn about this one.
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if (a == axis || lost_[a].now) continue;
      const double moved = rates[a] - lost.rates[a];
      if (moved * moved > kMostSquare * (variances[a] + lost.variances[a] + lost.variance))
        lost.moved = std::max(lost.moved, moved * moved);
    }
  }
  // It has one, and takes it in with this gain. variance: as the filter has it; beside, noise: what the rate
  // then is beside the measurement, and the variance of that one. Whatever was not known before, the rate is
  // off by no more than these two make.
  void measure(std::size_t axis, double gain, double variance, double beside, double noise) noexcept {
    Lost& lost = lost_[axis];
    if (!(lost.variance > 0.0)) return;
    if (lost.now) lost = {false, std::max(0.0, lost.variance + lost.moved - variance), 0.0, {}, {}};
    lost.variance = std::min(lost.variance * (1.0 - gain) * (1.0 - gain), beside * beside + noise);
    if (lost.variance < 1e-3 * variance) lost.variance = 0.0;
  }

  struct Lost {
    bool now = false;
    double variance = 0.0, moved = 0.0;
    Axes rates{}, variances{};  // of all axes when it was
  };
  std::array<Lost, kMaxAxes> lost_{};
};

}  // namespace ifog
