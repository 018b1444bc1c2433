// SPDX-License-Identifier: Apache-2.0
// A fault that its values alone can show: the sensor repeats the last one. Asked of what the sensor sent: a
// correction by something that is alive would hide it.
#pragma once

#include <array>
#include <cmath>
#include <cstdint>

#include "filters/settings/axes.h"

namespace ifog {

class SensorCheck {
 public:
  // A coarsely quantised sensor repeats itself at rest; so a run counts only when it is ten times longer than
  // any that ended in a new value, and a hundred samples at least.
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
