// SPDX-License-Identifier: Apache-2.0
// A stretch at a coarser step: differences of the means of 2^level neighbouring angles.
//
// Averages of the rate would keep one angle in 2^level. They would amplify quantisation, which is independent
// from sample to sample, until it hides white noise. Means of the angle use every sample and alias less.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/power_law.h"

namespace ifog {

class AngleMeans {
 public:
  // Uses `angles` angles from `first`, those of one stretch; `angle` must outlive this object, which needs
  // 1/32 of its memory.
  AngleMeans(std::span<const double> angle, std::size_t first, std::size_t angles);

  [[nodiscard]] std::size_t rates(int level) const;
  // Writes the rates from index `begin`, as many as fit, in rad/s. Level 0: the samples themselves.
  void rates(int level, std::size_t begin, std::span<double> rate) const;

 private:
  std::span<const double> angle_;
  std::size_t first_, angles_;
  std::vector<double> stored_;
};

// Number of lags in level_covariance(), in steps of the level.
inline constexpr std::size_t kLevelLags = 512;
// Generalised covariance of a level's rates by lag, for one unit of each term's variance in units of the
// level; multiply by level_unit() for units of the samples.
[[nodiscard]] std::span<const TermVariances> level_covariance(int level);
[[nodiscard]] TermVariances level_unit(int level);

}  // namespace ifog
