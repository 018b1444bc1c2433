// SPDX-License-Identifier: Apache-2.0
// How well the best of the trackers foresees an axis while its noise is not known yet.
//
// Innovations that are louder than third differences say are motion that the filter lags behind, or colour.
// A tracker tells which: it follows motion, and what it leaves is white noise as loud as it is rough. Of
// colour that doubles the innovations each leaves 1.8 times as much or more: noise that is alike from one
// sample to the next is rougher over the tracker's memory than from sample to sample. The two shortest
// trackers are not asked, being third differences themselves, or nearly so.
#pragma once

#include <algorithm>
#include <array>
#include <cstdint>

#include "filters/estimator/tracker_bank.h"

namespace ifog {

class Foresight {
 public:
  // Before correct(): a measurement whose noise has this part of the nominal variance.
  void take(const TrackerBank& trackers, std::size_t axis, double rate, double noise_scale) noexcept {
    for (std::size_t j = kFirst; j < trackers.size(); ++j) {
      if (trackers.factor(j) > kYoung) continue;
      const double apart = rate - trackers.rate(j, axis);
      squares_[j] += apart * apart / (trackers.factor(j) * noise_scale);
      ++count_[j];
    }
  }
  // Variance of the noise by the tracker that foresaw best, (rad/s)^2; huge where none has had the time.
  [[nodiscard]] double least() const noexcept {
    double least = kUnknown;
    for (std::size_t j = kFirst; j < squares_.size(); ++j)
      if (count_[j] >= kEnough) least = std::min(least, squares_[j] / count_[j]);
    return least;
  }

 private:
  static constexpr std::size_t kFirst = 2;
  // Innovation variance over the noise's of a tracker that has hardly begun.
  static constexpr double kYoung = 10.0;
  static constexpr int kEnough = 32;
  static constexpr double kUnknown = 1e300;

  std::array<double, TrackerBank::kMost> squares_{};
  std::array<int, TrackerBank::kMost> count_{};
};

}  // namespace ifog
