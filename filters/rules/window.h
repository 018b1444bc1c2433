// SPDX-License-Identifier: Apache-2.0
// Mean of the last N values in O(1) per step. After each round of the ring, that round's sum replaces the
// running sum, so rounding errors do not accumulate.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/rules/rule.h"

namespace ifog {

class Window {
 public:
  explicit Window(std::size_t length) : values_(length, 0.0) {}

  void insert(double value) noexcept {
    if (full()) sum_ -= values_[next_];
    values_[next_] = value;
    sum_ += value;
    round_sum_ += value;
    if (!full()) ++filled_;
    if (++next_ == values_.size()) {
      next_ = 0;
      sum_ = round_sum_;
      round_sum_ = 0.0;
    }
  }
  [[nodiscard]] bool full() const noexcept { return filled_ == values_.size(); }
  [[nodiscard]] double mean() const noexcept { return sum_ / static_cast<double>(filled_); }
  void clear() noexcept {
    next_ = filled_ = 0;
    sum_ = round_sum_ = 0.0;
  }

 private:
  std::vector<double> values_;
  std::size_t next_ = 0, filled_ = 0;
  double sum_ = 0.0, round_sum_ = 0.0;
};

// Axes share R, so their mean is used.
[[nodiscard]] inline double mean_square(std::span<const double> innovations) noexcept {
  double sum = 0.0;
  for (const double v : innovations) sum += v * v;
  return sum / static_cast<double>(innovations.size());
}

// A rule whose R is a mean over a window.
class WindowRule : public Rule {
 public:
  explicit WindowRule(const FilterSettings& settings)
      : noise_(settings.measurement_noise),
        least_(settings.floor * settings.measurement_noise),
        window_(static_cast<std::size_t>(settings.window)),
        estimate_(noise_) {}
  double measurement_noise() const noexcept override { return estimate_; }
  void restart() noexcept override {
    window_.clear();
    estimate_ = noise_;
  }

 protected:
  double noise_, least_;
  Window window_;
  double estimate_;
};

}  // namespace ifog
