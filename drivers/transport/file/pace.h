// SPDX-License-Identifier: Apache-2.0
// Replays recorded times by absolute deadlines relative to the first, so delays do not accumulate.
#pragma once

#include <cmath>
#include <cstdint>

namespace ifog {

class Pace {
 public:
  explicit Pace(double speed = 1.0) : speed_(speed) {}

  // recorded_ns: recorded time of the first item; now_ns: when it is due.
  void start(std::int64_t recorded_ns, std::int64_t now_ns) {
    recorded_start_ns_ = recorded_ns;
    start_ns_ = now_ns;
    started_ = true;
  }
  [[nodiscard]] bool started() const { return started_; }
  // Due time of an item, on the clock of start().
  [[nodiscard]] std::int64_t due_ns(std::int64_t recorded_ns) const {
    const std::int64_t since = recorded_ns - recorded_start_ns_;
    // Without conversion to double at speed 1: days in ns exceed 53 bits.
    return start_ns_ + (speed_ == 1.0 ? since : std::llround(static_cast<double>(since) / speed_));
  }

 private:
  double speed_;
  std::int64_t recorded_start_ns_ = 0, start_ns_ = 0;
  bool started_ = false;
};

}  // namespace ifog
