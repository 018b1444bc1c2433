// SPDX-License-Identifier: Apache-2.0
// Detects a sensor that repeats its last value. Uses raw values, because a correction with live channels
// would hide the fault.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

class SensorCheck {
 public:
  // A coarsely quantised sensor repeats values at rest. So a run counts if it exceeds 100 samples and ten
  // times the second longest earlier run: the longest may be a fault.
  [[nodiscard]] bool stuck(std::size_t axis, double value) noexcept {
    Run& run = runs_[axis];
    if (value != run.value) {
      run.second = std::max(run.second, std::min(run.length, run.longest));
      run.longest = std::max(run.longest, run.length);
      run.value = value;
      run.length = 0;
    }
    ++run.length;
    return run.length > kShortest && run.length > kTimesSecond * run.second;
  }

 private:
  static constexpr std::int64_t kShortest = 100;
  static constexpr std::int64_t kTimesSecond = 10;

  struct Run {
    double value = std::nan("");
    std::int64_t length = 0, longest = 0, second = 0;
  };
  std::array<Run, kMaxAxes> runs_{};
};

}  // namespace ifog
