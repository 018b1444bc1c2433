// SPDX-License-Identifier: Apache-2.0
// A rule whose opinion of R moves slowly: the gain is that of the average of what the rule has believed, not
// of what it believes at this sample.
//
// A gain that follows the innovations is not the same going into a turn as coming out of it, and gives a
// large innovation less weight than a small one: in noise of skewness g IRWE-AKFG stands off by g sigma / N,
// which at Q/R = 1e-9 is seven times the error of the filter. An average that holds none of the current
// innovation does neither, and at rest no gain is better than a steady one.
#pragma once

#include <algorithm>
#include <memory>
#include <utility>

#include "filters/rules/rule.h"

namespace ifog {

class SteadyGain final : public Rule {
 public:
  explicit SteadyGain(std::unique_ptr<Rule> rule)
      : rule_(std::move(rule)), told_(rule_->measurement_noise()), noise_(told_) {}

  double innovation_covariance(const RuleInput& in) noexcept override {
    const double c = in.projected + louder_ * noise_ * in.noise_scale;
    const double found = (rule_->innovation_covariance(in) - in.projected) / in.noise_scale;
    if (averaged_ > 0.0) {
      averaged_ = std::min(averaged_ + 1.0, kMemory);
      noise_ = std::clamp(noise_ + (std::min(found, kMost * noise_) - noise_) / averaged_, least(), most_);
    }
    return c;
  }
  double measurement_noise() const noexcept override { return noise_; }

  // Until this is called R is what the filter was told: from here on the average of `noise`, known from so
  // many samples, and of what the rule believes.
  void begin(double noise, double samples) noexcept {
    noise_ = std::max(noise, least());
    averaged_ = samples;
  }
  // Of the next measurement R is so many times what has been learned of it so far.
  void hear_louder(double times) noexcept { louder_ = times; }
  // R is at most this; what is above it is motion that the filter lags behind.
  void limit(double noise) noexcept { most_ = std::max(noise, least()); }

  void restart() noexcept override {
    rule_->restart();
    noise_ = told_;
    averaged_ = 0.0;
    most_ = 1e300;
    louder_ = 1.0;
  }
  std::uint64_t floor_hits() const noexcept override { return rule_->floor_hits(); }

 private:
  // Samples of the average: 4 % of R, 1 % of RMSE.
  static constexpr double kMemory = 1024.0;
  // What one opinion counts for at most, in R: a window that holds an outlier.
  static constexpr double kMost = 25.0;

  // A sensor may repeat one value for long; R never becomes nothing.
  [[nodiscard]] double least() const noexcept { return 1e-9 * told_; }

  std::unique_ptr<Rule> rule_;
  double told_, noise_;
  double most_ = 1e300;
  double louder_ = 1.0;
  double averaged_ = 0.0;  // samples; 0: not begun
};

}  // namespace ifog
