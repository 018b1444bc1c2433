// SPDX-License-Identifier: Apache-2.0
// The time of a sensor's messages, in s from the first.
#pragma once

#include <cmath>
#include <cstdint>
#include <ifog/rate_t.hpp>
#include <utility>

namespace ifog::tools {

// The sensor's own clock where it has one, from the first message on. If it jumps back while the fitted time
// advances, it has restarted or was set, and continues by the fitted time. Where that was set or stands still,
// too, the message's own step counts.
class SensorSeconds {
 public:
  // Later than the one before, or -1: neither clock goes on.
  double of(const rate_t& message) {
    const std::int64_t fitted_ns = message.utime * 1000;
    std::int64_t now_ns = (message.sensor_time_ns != -1 ? message.sensor_time_ns : fitted_ns) + shift_ns_;
    const bool sensor = message.sensor_time_ns != -1, set = (message.flags & rate_t::FLAG_CLOCK_STEP) != 0;
    const std::int32_t own =
        sensor ? std::int32_t{rate_t::FLAG_SENSOR_CLOCK_SET} : std::int32_t{rate_t::FLAG_CLOCK_STEP};
    const bool own_set = (message.flags & own) != 0;
    if (started_ && (now_ns <= last_ns_ || own_set)) {
      const bool goes_on = !set && fitted_ns > last_fitted_ns_;
      const std::int64_t step_ns = goes_on ? fitted_ns - last_fitted_ns_ : step_of(message);
      if (step_ns <= 0) return -1.0;
      const std::int64_t back_ns = last_ns_ + step_ns - now_ns;
      shift_ns_ += back_ns;
      now_ns += back_ns;
    }
    if (!std::exchange(started_, true)) start_ns_ = now_ns;
    last_ns_ = now_ns;
    last_fitted_ns_ = fitted_ns;
    last_seq_ = message.seq;
    return static_cast<double>(now_ns - start_ns_) / 1e9;
  }

 private:
  // 0: it has none.
  [[nodiscard]] std::int64_t step_of(const rate_t& message) const {
    const bool known = message.seq > last_seq_ && message.dt > 0.0 && message.dt < 1e9;
    return known ? std::llround(message.dt * 1e9) : 0;
  }
  bool started_ = false;
  std::int64_t start_ns_ = 0, last_ns_ = 0, last_fitted_ns_ = 0, last_seq_ = 0, shift_ns_ = 0;
};

}  // namespace ifog::tools
