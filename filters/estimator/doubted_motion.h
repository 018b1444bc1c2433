// SPDX-License-Identifier: Apache-2.0
// Whether a sensor whose noise is not known from rest yet moves at all.
//
// Now and then coloured noise begins like a motion, and then the trackers foresee it for ever, as they would
// a motion. But what they take for one goes about a mean, is no louder than the noise that the filter was
// told, and is foreseen less well than the noise that is heard would let a motion be (Foresight): then it is
// the noise that was told.
#pragma once

#include <array>
#include <cstdint>

#include "filters/estimator/foresight.h"
#include "filters/settings/axes.h"

namespace ifog {

class DoubtedMotion {
 public:
  // Before correct(): a measurement whose noise has this part of the nominal variance.
  void take(const TrackerBank& trackers, const Axes& rate, std::uint32_t valid, double noise_scale) noexcept {
    if (complete()) *this = {};
    ++in_sum_;
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if ((valid >> a & 1U) == 0) continue;
      foresight_[a].take(trackers, a, rate[a], noise_scale);
      // From the first one on, so that the squares keep their digits.
      if (counts_[a] == 0.0) first_[a] = rate[a];
      const double apart = rate[a] - first_[a];
      sum_[a] += apart;
      squares_[a] += apart * apart;
      counts_[a] += 1.0;
    }
  }
  // Enough have come since it was last; what follows is of these.
  [[nodiscard]] bool complete() const noexcept { return in_sum_ == kSamples; }
  [[nodiscard]] double count(std::size_t axis) const noexcept { return counts_[axis]; }
  [[nodiscard]] double mean(std::size_t axis) const noexcept {
    return first_[axis] + sum_[axis] / counts_[axis];
  }
  [[nodiscard]] double variance(std::size_t axis) const noexcept {
    const double mean = sum_[axis] / counts_[axis];
    return squares_[axis] / counts_[axis] - mean * mean;
  }
  // Variance of the noise by the tracker that foresaw best.
  [[nodiscard]] double foreseen(std::size_t axis) const noexcept { return foresight_[axis].least(); }

 private:
  // Ten correlation times of noise whose neighbours are correlated by 0.98.
  static constexpr int kSamples = 1024;

  std::array<Foresight, kMaxAxes> foresight_{};
  Axes first_{}, sum_{}, squares_{}, counts_{};
  int in_sum_ = 0;
};

}  // namespace ifog
