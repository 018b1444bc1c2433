// SPDX-License-Identifier: Apache-2.0
// Overlapping Allan deviation of a rate, from one running sum.
//
// Riley, "Handbook of frequency stability analysis", NIST Special Publication 1065 (2008), equations 10, 15
// and 26; IEEE Std 952 calls the same thing the Allan variance of Ω.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

// The angle at each instant, in units of (rad/s × sample): running sum of the rate less its mean, each
// stretch starting at zero. The sum is carried in two doubles, so that every entry is rounded once, however
// long the record: 10⁸ samples with a bias a million times their noise keep nine digits of the deviation at
// one sample.
class AngleSum {
 public:
  // No NaN inside a stretch. Takes 8 bytes a sample.
  AngleSum(std::span<const double> rate_radps, std::span<const Stretch> stretches);
  // The same in the samples' own memory, where one stretch covers them all and the vector has room for one
  // more; else by a copy, and the samples are freed afterwards.
  AngleSum(std::vector<double>&& rate_radps, std::span<const Stretch> stretches);

  struct Part {
    std::size_t first;   // index of its first angle
    std::size_t angles;  // one more than its samples
  };
  [[nodiscard]] const std::vector<double>& angle() const { return angle_; }
  [[nodiscard]] const std::vector<Part>& parts() const { return parts_; }
  [[nodiscard]] double mean_radps() const { return mean_; }
  [[nodiscard]] std::size_t samples() const { return angle_.size() - parts_.size(); }
  [[nodiscard]] std::size_t longest() const;  // samples of the longest stretch

 private:
  void find_mean(std::span<const double> rate_radps, std::span<const Stretch> stretches);
  void sum_up(std::span<const double> rate_radps, std::span<const Stretch> stretches);

  std::vector<double> angle_;
  std::vector<Part> parts_;
  double mean_ = 0.0;
};

enum class Deviation {
  kAllan,     // second differences of the angle
  kModified,  // the same, averaged over m neighbours: tells white from flicker phase noise
  kHadamard,  // third differences: blind to a rate ramp
};

// Mean square over all places where the difference fits inside one stretch.
struct DeviationPoint {
  std::size_t m = 0;      // averaging time in samples
  std::size_t terms = 0;  // squares averaged; 0: no stretch is long enough
  double variance = 0.0;  // (rad/s)²; NaN when terms is 0
};

// The longest averaging time at which a difference fits into a stretch of so many samples; 0 if none does.
[[nodiscard]] std::size_t longest_average(Deviation kind, std::size_t samples);

// One point per entry of m (each >= 1), in that order.
[[nodiscard]] std::vector<DeviationPoint> deviation(const AngleSum& sum, std::span<const std::size_t> m,
                                                    Deviation kind = Deviation::kAllan);

// Averaging times in samples, `per_decade` to a factor of ten, without repeats, from 1 to longest.
[[nodiscard]] std::vector<std::size_t> log_spaced(std::size_t longest, int per_decade);

}  // namespace ifog
