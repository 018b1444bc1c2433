// SPDX-License-Identifier: Apache-2.0
// Continuous tests with a given time between false alarms, on figures of blocks at rest. Not for real-time
// threads.
//
// CUSUM of a log-likelihood ratio (E. S. Page, Biometrika 41, 1954): with threshold h = ln(blocks) the mean
// time to a false alarm is at least `blocks`, for any distribution with that likelihood ratio (G. Lorden,
// Ann. Math. Statist. 42, 1971), and longer if the truth is further from the alternative.
#pragma once

#include <algorithm>
#include <cmath>

namespace ifog {

// Tests if a rare state has become usual: blocks are odd with probability 0.01 at most before, 0.9 after.
class UsualCusum {
 public:
  explicit UsualCusum(double threshold) : threshold_(threshold) {}
  void take(bool odd) noexcept {
    constexpr double kBefore = 0.01, kAfter = 0.9;
    static const double up = std::log(kAfter / kBefore), down = std::log((1.0 - kAfter) / (1.0 - kBefore));
    // Limited, so that recovery takes no longer than the rise.
    sum_ = std::clamp(sum_ + (odd ? up : down), 0.0, 2.0 * threshold_);
    if (sum_ > threshold_) alarmed_ = true;
    if (sum_ == 0.0) alarmed_ = false;
  }
  // True above the threshold, until the sum is zero again.
  [[nodiscard]] bool alarmed() const noexcept { return alarmed_; }
  void restart() noexcept {
    sum_ = 0.0;
    alarmed_ = false;
  }

 private:
  double threshold_, sum_ = 0.0;
  bool alarmed_ = false;
};

// Tests if a white series of variance 1 has become correlated with its last value by `kFollows`.
class ColourCusum {
 public:
  static constexpr double kFollows = 0.6;
  explicit ColourCusum(double threshold) : threshold_(threshold) {}
  void take(double value) noexcept {
    if (known_)
      sum_ = std::clamp(sum_ + kFollows * last_ * value - 0.5 * kFollows * kFollows * last_ * last_, 0.0,
                        2.0 * threshold_);
    last_ = value;
    known_ = true;
    if (sum_ > threshold_) alarmed_ = true;
    if (sum_ == 0.0) alarmed_ = false;
  }
  void break_off() noexcept { known_ = false; }
  [[nodiscard]] bool alarmed() const noexcept { return alarmed_; }
  void restart() noexcept {
    sum_ = 0.0;
    alarmed_ = known_ = false;
  }

 private:
  double threshold_, sum_ = 0.0, last_ = 0.0;
  bool known_ = false, alarmed_ = false;
};

}  // namespace ifog
