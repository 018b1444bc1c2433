// SPDX-License-Identifier: Apache-2.0
// Tests that look at a sensor for ever and may cry wolf once in a given time, on figures of blocks of its
// samples at rest. Nothing here is a real-time thread's.
//
// CUSUM of a log likelihood ratio (E. S. Page, Biometrika 41, 1954): above h = ln(blocks), the time to a
// false alarm is `blocks` or more, whatever the law, as long as the ratio is one (G. Lorden, Ann. Math.
// Statist. 42, 1971). Where what holds is further from the alternative than the law that the ratio has, it is
// longer.
#pragma once

#include <algorithm>
#include <cmath>

namespace ifog {

// Whether a state that is rare has become usual: blocks are odd with probability 0.01 at most before, 0.9
// after.
class UsualCusum {
 public:
  explicit UsualCusum(double threshold) : threshold_(threshold) {}
  void take(bool odd) noexcept {
    constexpr double kBefore = 0.01, kAfter = 0.9;
    static const double up = std::log(kAfter / kBefore), down = std::log((1.0 - kAfter) / (1.0 - kBefore));
    // No further than it takes as long to come back as it took to rise.
    sum_ = std::clamp(sum_ + (odd ? up : down), 0.0, 2.0 * threshold_);
    if (sum_ > threshold_) alarmed_ = true;
    if (sum_ == 0.0) alarmed_ = false;
  }
  // Once beyond the threshold, until it is back at zero.
  [[nodiscard]] bool alarmed() const noexcept { return alarmed_; }
  void restart() noexcept {
    sum_ = 0.0;
    alarmed_ = false;
  }

 private:
  double threshold_, sum_ = 0.0;
  bool alarmed_ = false;
};

// Whether a white series of variance 1 has come to follow its own last value by `kFollows`.
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
