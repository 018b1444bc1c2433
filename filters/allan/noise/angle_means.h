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
#include "filters/series/series_view.h"

namespace ifog {

class AngleMeans {
 public:
  // `angles` of them from `first` on: those of one stretch, which have to outlive this. Takes a thirty-second
  // of their memory.
  AngleMeans(const SeriesView& angle, std::size_t first, std::size_t angles);

  [[nodiscard]] std::size_t rates(int level) const;
  // rate[i] for i from `begin`, as many as fit; rad/s. Level 0: the samples themselves.
  void rates(int level, std::size_t begin, std::span<double> rate) const;

 private:
  SeriesView angle_;
  std::size_t first_, angles_;
  std::vector<double> stored_;
};

// Lags that the covariance is known for, in steps of a level.
inline constexpr std::size_t kLevelLags = 512;
// Generalised covariance of such rates at a lag, for one unit of each term's variance in the unit of the
// level: times level_unit() for one of the samples' own.
[[nodiscard]] std::span<const TermVariances> level_covariance(int level);
[[nodiscard]] TermVariances level_unit(int level);

}  // namespace ifog
