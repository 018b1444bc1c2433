// SPDX-License-Identifier: Apache-2.0
// Test for motion: compares each tracker with the filter at rest, and the raw measurement with both.
//
// Page's test (Biometrika 41, 1954): the log-likelihood ratio of a tracker's predictions to those of the
// filter at rest, both with the known R, is summed with fading memory over the tracker's horizon. README.md
// derives it, and what it knows of tails and colour.
#pragma once

#include <array>
#include <cstddef>
#include <functional>
#include <optional>

#include "filters/estimator/sample.h"
#include "filters/estimator/trackers.h"

namespace ifog {

class ChangeTest {
 public:
  // colour: of the state model, for sums whose memory keeps a share; RestFilter::colour_of_sum().
  ChangeTest(const Trackers& trackers, const std::function<double(double)>& colour);

  // Index that means "no tracker predicts; the measurements exceed the known noise".
  static constexpr std::size_t kShaking = Trackers::kMost;

  // Returns the tracker that predicts the change, kShaking, or nullopt; to be called before
  // Trackers::correct(). rarity: Outliers::rarity(); lag: of the filter at rest, samples.
  std::optional<std::size_t> take(const Trackers& trackers, const Sample& now, double rarity,
                                  double lag) noexcept;
  // To be called when a manoeuvre is detected or the filter starts; keeps what is known of the noise.
  void begin() noexcept;
  [[nodiscard]] bool suspected() const noexcept { return suspected_; }
  // Angle error of the filter at rest over the tracker's horizon, rad.
  [[nodiscard]] const Lanes& angle(std::size_t tracker) const noexcept { return short_[tracker]; }
  void forget_angle() noexcept { short_.fill(Lanes::Zero()); }
  // Variance because of a change that may have begun undetected, (rad/s)^2.
  [[nodiscard]] const Lanes& change_variance() const noexcept { return change_variance_; }

 private:
  struct Contest {
    Lanes ratio = Lanes::Zero(), sum = Lanes::Zero(), weight = Lanes::Zero();
    Lanes times = Lanes::Zero();         // time in which a change was likely to have begun
    double shrinks = 0.0, spread = 0.0;  // of an offset's likelihood
    double keep = 0.0, worth = 0.0;      // 1 - 1 / h and 1 / (2 h - 1) for horizon h
    double colour = 1.0;  // variance of the sum because of the model's colour / that of white noise
    Lanes rest = Lanes::Zero(), rest2 = Lanes::Zero(), tracker = Lanes::Zero();
  };
  struct Common {
    // Differences from the filter at rest clipped, squared, squared and limited; the innovations' variance relative to R.
    Lanes clipped, apart, squares, second;
    double cap, log_rest;
  };
  void contest(const Trackers& trackers, std::size_t j, const Sample& now, const Common& common) noexcept;
  void expect(Contest& c, double h, const Lanes& nats, const Sample& now) noexcept;
  [[nodiscard]] double same_size(const Contest& c, Eigen::Index a) const noexcept;

  std::array<Contest, Trackers::kMost> contest_{};
  std::array<Lanes, Trackers::kMost> short_;
  Lanes shaking_ = Lanes::Zero();
  Lanes second_ = Lanes::Ones(), fourth_ = Lanes::Constant(3.0);  // moments of the innovations
  Lanes change_variance_ = Lanes::Zero();
  double seen_ = 64.0, age_ = 0.0;  // age_: samples at rest
  bool suspected_ = false;
};

}  // namespace ifog
