// SPDX-License-Identifier: Apache-2.0
// A stretch at a coarser step: differences of the means of 2^level neighbouring angles.
//
// Averages of the rate would keep one angle in 2^level and so take quantisation, an error of the angle that
// is independent from sample to sample, for 2^level times what it is at low frequencies: white noise that is
// plain to see in all samples would drown in it. Means of the angle keep what every sample says of it, and
// fold less of what is fast onto what is slow.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/power_law.h"

namespace ifog {

class AngleMeans {
 public:
  // The angles of one stretch, which have to outlive this. Takes a thirty-second of their memory.
  explicit AngleMeans(std::span<const double> angle);

  [[nodiscard]] std::size_t rates(int level) const;
  // rate[i] for i from `begin`, as many as fit; rad/s. Level 0: the samples themselves.
  void rates(int level, std::size_t begin, std::span<double> rate) const;

 private:
  [[nodiscard]] double mean(int level, std::size_t i) const;

  std::span<const double> angle_;
  std::vector<double> stored_;
};

// Lags that the covariance is known for, in steps of a level.
inline constexpr std::size_t kLevelLags = 512;
// Generalised covariance of such rates at a lag, for one unit of each term's variance in the unit of the
// level: times level_unit() for one of the samples' own.
[[nodiscard]] std::span<const TermVariances> level_covariance(int level);
[[nodiscard]] TermVariances level_unit(int level);

}  // namespace ifog
