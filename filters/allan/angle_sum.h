// SPDX-License-Identifier: Apache-2.0
// Running sum of a rate, from which all variances of the Allan family are computed.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/series/samples.h"

namespace ifog {

// Angle at each instant in (rad/s × sample): running sum of the rate minus its mean; each part starts at
// zero. Each entry is rounded once (sum in two doubles). So 10⁸ samples whose bias is a million times the
// noise keep nine digits of the deviation at one sample. A part is one stretch, or several with the holes
// between them filled, where that changes no variance of the Allan family by more than 2 % and the rate does not step.
class AngleSum {
 public:
  enum class Holes { kFilledIfNegligible, kFilled };  // Stretch::lost
  // Needs 8 bytes per sample, in memory or in a file like the rates. No NaN inside a stretch.
  AngleSum(std::span<const double> rate_radps, std::span<const Stretch> stretches,
           Holes holes = Holes::kFilledIfNegligible);

  struct Part {
    std::size_t first;  // index of its first angle
    std::size_t angles;
  };
  [[nodiscard]] std::span<const double> angle() const { return angle_; }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] double mean_radps() const { return mean_; }
  [[nodiscard]] std::size_t samples() const { return angle_.size() - parts_.size() - filled_; }
  [[nodiscard]] std::size_t filled() const { return filled_; }  // samples in holes, besides samples()
  [[nodiscard]] std::size_t longest() const;                    // samples of the longest part
  // Samples for which a logger holds each value (runs.h): shorter averages show the logger.
  [[nodiscard]] std::size_t held() const { return held_; }

 private:
  static std::vector<Stretch> negligible(std::span<const double> rate_radps,
                                         std::span<const Stretch> stretches);
  void sum_up(std::span<const double> rate_radps, std::span<const Stretch> stretches);

  Samples angle_;
  std::vector<Part> parts_;
  double mean_ = 0.0;
  std::size_t filled_ = 0, held_ = 1;
};

}  // namespace ifog
