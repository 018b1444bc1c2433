// SPDX-License-Identifier: Apache-2.0
// The running sum of a rate, of which every Allan-like variance is made.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/series/long_series.h"
#include "filters/series/series_view.h"

namespace ifog {

// The angle at each instant, in units of (rad/s × sample): running sum of the rate less its mean, each
// stretch starting at zero. The sum is carried in two doubles, so that every entry is rounded once, however
// long the record: 10⁸ samples with a bias a million times their noise keep nine digits of the deviation at
// one sample.
class AngleSum {
 public:
  // The angles of more rates than this are in a file.
  static constexpr std::size_t kMostInMemory = std::size_t{1} << 23U;

  // No NaN inside a stretch. Takes 8 bytes a sample, in memory where the rates are, else in a file.
  AngleSum(const SeriesView& rate_radps, std::span<const Stretch> stretches);
  // The same in the samples' own memory, where one stretch covers them all and the vector has room for one
  // more; else by a copy, and the samples are freed afterwards.
  AngleSum(std::vector<double>&& rate_radps, std::span<const Stretch> stretches);

  struct Part {
    std::size_t first;   // index of its first angle
    std::size_t angles;  // one more than its samples
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
  LongSeries long_;  // instead
  std::vector<Part> parts_;
  double mean_ = 0.0;
};

}  // namespace ifog
