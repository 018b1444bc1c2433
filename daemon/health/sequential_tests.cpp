// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/sequential_tests.h"

#include <algorithm>
#include <cmath>

namespace ifog {
namespace {

// Odds of UsualCusum.
constexpr double kBefore = 0.01, kAfter = 0.9;

}  // namespace

void UsualCusum::take(bool odd) noexcept {
  static const double up = std::log(kAfter / kBefore), down = std::log((1.0 - kAfter) / (1.0 - kBefore));
  // No further than it takes as long to come back as it took to rise.
  sum_ = std::clamp(sum_ + (odd ? up : down), 0.0, 2.0 * threshold_);
  if (sum_ > threshold_) alarmed_ = true;
  if (sum_ == 0.0) alarmed_ = false;
}

void ColourCusum::take(double value) noexcept {
  if (known_)
    sum_ = std::clamp(sum_ + kFollows * last_ * value - 0.5 * kFollows * kFollows * last_ * last_, 0.0,
                      2.0 * threshold_);
  last_ = value;
  known_ = true;
  if (sum_ > threshold_) alarmed_ = true;
  if (sum_ == 0.0) alarmed_ = false;
}

}  // namespace ifog
