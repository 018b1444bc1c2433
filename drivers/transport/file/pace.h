// SPDX-License-Identifier: Apache-2.0
// Recorded times replayed against absolute deadlines: each is computed from the first, so lateness never adds
// up.
#pragma once

#include <cmath>
#include <cstdint>

namespace ifog {

class Pace {
 public:
  explicit Pace(double speed = 1.0) : speed_(speed) {}

  // `recorded_ns` is the first item's recorded time, `now_ns` the clock at which it is due.
  void start(std::int64_t recorded_ns, std::int64_t now_ns) {
    recorded_start_ns_ = recorded_ns;
    start_ns_ = now_ns;
    started_ = true;
  }
  [[nodiscard]] bool started() const { return started_; }
  // When the item recorded at `recorded_ns` is due, on the clock given to start().
  [[nodiscard]] std::int64_t due_ns(std::int64_t recorded_ns) const {
    const std::int64_t since = recorded_ns - recorded_start_ns_;
    // At speed 1 no rounding through a double: days of nanoseconds do not fit its 53 bits.
    return start_ns_ + (speed_ == 1.0 ? since : std::llround(static_cast<double>(since) / speed_));
  }

 private:
  double speed_;
  std::int64_t recorded_start_ns_ = 0, start_ns_ = 0;
  bool started_ = false;
};

}  // namespace ifog
