// SPDX-License-Identifier: Apache-2.0
// Continuous tests with a given time between false alarms, on figures of blocks at rest. Not for real-time
// threads.
#pragma once

#include <algorithm>
#include <cmath>

namespace ifog {

// CUSUM of a log-likelihood ratio (E. S. Page, Biometrika 41, 1954): with threshold h = ln(blocks) the mean
// time to a false alarm is at least `blocks`, for any distribution with that likelihood ratio (G. Lorden,
// Ann. Math. Statist. 42, 1971), and longer if the truth is further from the alternative.
class Cusum {
 public:
  explicit Cusum(double threshold) : threshold_(threshold) {}
  void add(double log_ratio) noexcept {
    // Limited, so that recovery takes no longer than the rise.
    sum_ = std::clamp(sum_ + log_ratio, 0.0, 2.0 * threshold_);
    if (sum_ > threshold_) alarmed_ = true;
    if (sum_ == 0.0) alarmed_ = false;
  }
  // True above the threshold, until the sum is zero again.
  [[nodiscard]] bool alarmed() const noexcept { return alarmed_; }

 private:
  double threshold_, sum_ = 0.0;
  bool alarmed_ = false;
};

// A rare state has become usual: blocks are odd with probability 0.01 at most before, 0.9 after.
inline double usual_log_ratio(bool odd) noexcept {
  constexpr double kBefore = 0.01, kAfter = 0.9;
  return odd ? std::log(kAfter / kBefore) : std::log((1.0 - kAfter) / (1.0 - kBefore));
}

// A white series of variance 1 has become correlated with its last value by `kFollows`.
inline double colour_log_ratio(double last, double value) noexcept {
  constexpr double kFollows = 0.6;
  return kFollows * last * value - 0.5 * kFollows * kFollows * last * last;
}

}  // namespace ifog
