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
  // The axis has no measurement of this sample, another has. grown: by which the filter's variance has, of
  // the axis' own walk; rates, variances: of all axes, as the filter has them.
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
  // None has.
  void miss_with_all(std::size_t axis, double grown) noexcept {
    if (lost_[axis].now) lost_[axis].variance += grown;
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
  // Variance of the axis, where the filter's is `filters`.
  [[nodiscard]] double variance(std::size_t axis, double filters) const noexcept {
    const Lost& lost = lost_[axis];
    return lost.now ? std::max(filters, lost.variance + lost.moved) : filters + lost.variance;
  }

 private:
  struct Lost {
    bool now = false;
    double variance = 0.0, moved = 0.0;
    Axes rates{}, variances{};  // of all axes when it was
  };
  std::array<Lost, kMaxAxes> lost_{};
};

}  // namespace ifog
