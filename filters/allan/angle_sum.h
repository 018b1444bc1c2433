// SPDX-License-Identifier: Apache-2.0
// Running sum of a rate, from which all variances of the Allan family are computed.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/series/long_series.h"
#include "filters/series/series_view.h"

namespace ifog {

// Angle at each instant in (rad/s × sample): running sum of the rate minus its mean; each stretch starts at
// zero. Each entry is rounded once (sum in two doubles). So 10⁸ samples whose bias is a million times the
// noise keep nine digits of the deviation at one sample.
class AngleSum {
 public:
  // Longer series are kept in a file.
  static constexpr std::size_t kMostInMemory = std::size_t{1} << 23U;

  // Needs 8 bytes per sample, in memory or in a file like the rates. No NaN inside a stretch.
  AngleSum(const SeriesView& rate_radps, std::span<const Stretch> stretches);
  // Reuses the vector's memory if one stretch covers all samples and the vector has capacity for one more;
  // else copies and then frees it.
  AngleSum(std::vector<double>&& rate_radps, std::span<const Stretch> stretches);

  struct Part {
    std::size_t first;  // index of its first angle
    std::size_t angles;
  };
  [[nodiscard]] SeriesView angle() const;
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] double mean_radps() const { return mean_; }
  [[nodiscard]] std::size_t samples() const { return angle().size() - parts_.size(); }
  [[nodiscard]] std::size_t longest() const;  // samples of the longest stretch

 private:
  void find_mean(const SeriesView& rate_radps, std::span<const Stretch> stretches);
  template <typename Add>
  void sum_up(const SeriesView& rate_radps, std::span<const Stretch> stretches, Add add);

  std::vector<double> angle_;
  LongSeries long_;  // used instead of angle_ for long series
  std::vector<Part> parts_;
  double mean_ = 0.0;
};

}  // namespace ifog
