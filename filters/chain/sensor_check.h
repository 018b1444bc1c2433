// SPDX-License-Identifier: Apache-2.0
// Detects a sensor that repeats its last value. Uses raw values, because a correction with live channels
// would hide the fault.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

class SensorCheck {
 public:
  // A coarsely quantised sensor repeats values at rest. So a run counts if it exceeds 100 samples and ten
  // times the longest earlier run.
  [[nodiscard]] bool stuck(std::size_t axis, double value) noexcept {
    Run& run = runs_[axis];
    if (value != run.value) {
      if (run.length > run.longest) run.longest = run.length;
      run.value = value;
      run.length = 0;
    }
    ++run.length;
    return run.length > kShortest && run.length > kTimesLongest * run.longest;
  }

 private:
  static constexpr std::int64_t kShortest = 100;
  static constexpr std::int64_t kTimesLongest = 10;

  struct Run {
    double value = std::nan("");
    std::int64_t length = 0, longest = 0;
  };
  std::array<Run, kMaxAxes> runs_{};
};

}  // namespace ifog
