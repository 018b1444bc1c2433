// SPDX-License-Identifier: Apache-2.0
// Whether a filter that has been under way since its first samples moves at all.
//
// Now and then coloured noise begins like a motion, and then the trackers foresee it for ever, as they would
// a motion. But what they take for one goes about a mean, and is no louder than the noise that the filter was
// told, while the noise that is heard is much quieter than that: then it was this noise that was told. Of a
// motion beside the noise that was told there would be that noise to be heard.
#pragma once

#include <array>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

class DoubtedMotion {
 public:
  // A measurement; true when enough have come, and mean() and variance() are theirs.
  bool take(const Axes& rate, std::uint32_t valid) noexcept {
    if (in_sum_ == kSamples) sum_ = squares_ = counts_ = {}, in_sum_ = 0;
    for (std::size_t a = 0; a < kMaxAxes; ++a) {
      if ((valid >> a & 1U) == 0) continue;
      // From the first one on, so that the squares keep their digits.
      if (counts_[a] == 0.0) first_[a] = rate[a];
      const double apart = rate[a] - first_[a];
      sum_[a] += apart;
      squares_[a] += apart * apart;
      counts_[a] += 1.0;
    }
    return ++in_sum_ == kSamples;
  }
  [[nodiscard]] double count(std::size_t axis) const noexcept { return counts_[axis]; }
  [[nodiscard]] double mean(std::size_t axis) const noexcept {
    return first_[axis] + sum_[axis] / counts_[axis];
  }
  [[nodiscard]] double variance(std::size_t axis) const noexcept {
    const double mean = sum_[axis] / counts_[axis];
    return squares_[axis] / counts_[axis] - mean * mean;
  }

 private:
  // Ten correlation times of noise whose neighbours are correlated by 0.98.
  static constexpr int kSamples = 1024;

  Axes first_{}, sum_{}, squares_{}, counts_{};
  int in_sum_ = 0;
};

}  // namespace ifog
