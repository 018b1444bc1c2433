// SPDX-License-Identifier: Apache-2.0
// How well the filter at rest does by its own innovations: normalised innovation squared, lag-1
// autocorrelation, and whether it is lost.
#pragma once

#include <algorithm>
#include <cstddef>

#include "filters/estimator/estimator.h"

namespace ifog {

class Grades {
 public:
  // normalised: innovation over the standard deviation that the filter gives it.
  void take(std::size_t axis, double normalised, EstimatorHealth& health) noexcept {
    Grade& grade = grades_[axis];
    grade.count = std::min(grade.count + 1.0, kMemory);
    grade.square += (normalised * normalised - grade.square) / grade.count;
    grade.product += (normalised * grade.last - grade.product) / grade.count;
    grade.last = normalised;
    // From zero, so that it takes most of the memory to be lost: not the start of an adaptive rule.
    grade.beyond += ((normalised * normalised > kBeyond * kBeyond ? 1.0 : 0.0) - grade.beyond) / kMemory;
    health.nis_mean[axis] = grade.square;
    health.whiteness[axis] = grade.square > 0.0 ? grade.product / grade.square : 0.0;
  }
  // More than half of the innovations lie beyond three standard deviations, which no rule that has adapted
  // and no outlier brings about. Once: starting again does not mend a wrong noise.
  [[nodiscard]] bool newly_lost() noexcept {
    double most = 0.0;
    for (const Grade& grade : grades_) most = std::max(most, grade.beyond);
    const bool newly = most > kLost && !lost_;
    lost_ = most > kLost || (lost_ && most >= kWell);
    return newly;
  }

 private:
  static constexpr double kMemory = 512.0, kBeyond = 3.0, kLost = 0.5, kWell = 0.1;
  struct Grade {
    double square = 1.0, product = 0.0, last = 0.0, count = 0.0, beyond = 0.0;
  };
  std::array<Grade, kMaxAxes> grades_{};
  bool lost_ = false;
};

}  // namespace ifog
