// SPDX-License-Identifier: Apache-2.0
// A device's time stamp, carried on over its wraps.
#pragma once

#include <cmath>
#include <cstdint>

namespace ifog::framing {

class DeviceClock {
 public:
  // A stamp counts ticks of so many nanoseconds.
  explicit DeviceClock(std::int64_t tick_ns) : tick_ns_(tick_ns) {}

  // The device's time in ns, from any origin. `modulus`: the ticks after which the stamp begins again. A
  // pause longer than one wrap is bridged by the arrival times; 0: not known.
  std::int64_t next_ns(std::uint32_t stamp, std::int64_t arrival_ns, std::int64_t modulus) noexcept {
    if (started_) {
      std::int64_t step = static_cast<std::int64_t>(stamp) - last_;
      if (step < 0) step += modulus;
      time_ += step;
      if (arrival_ns > 0 && known_arrival_ns_ > 0) {
        // Against the latest arrival that is known: between two of them stamps alone count.
        const double missing =
            static_cast<double>(arrival_ns - known_arrival_ns_) / static_cast<double>(tick_ns_) -
            static_cast<double>(time_ - known_time_);
        const double wraps = std::round(missing / static_cast<double>(modulus));
        if (wraps >= 1.0 && wraps < 1e6) time_ += static_cast<std::int64_t>(wraps) * modulus;
      }
    } else {
      time_ = stamp;
    }
    started_ = true;
    last_ = stamp;
    if (arrival_ns > 0) {
      known_arrival_ns_ = arrival_ns;
      known_time_ = time_;
    }
    return time_ * tick_ns_;
  }
  // The device may have been switched off in between: the next stamp starts anew.
  void restart() noexcept {
    started_ = false;
    known_arrival_ns_ = 0;
  }
  // The inverse: the stamp a device sends at this time. Times before the origin stay in order.
  [[nodiscard]] std::uint32_t stamp_at(std::int64_t time_ns, std::int64_t modulus) const noexcept {
    const std::int64_t ticks = time_ns / tick_ns_ - (time_ns % tick_ns_ < 0 ? 1 : 0);
    const std::int64_t stamp = ticks % modulus;
    return static_cast<std::uint32_t>(stamp < 0 ? stamp + modulus : stamp);
  }

 private:
  std::int64_t tick_ns_;
  bool started_ = false;
  std::int64_t last_ = 0, time_ = 0;                    // ticks
  std::int64_t known_arrival_ns_ = 0, known_time_ = 0;  // at the latest stamp whose arrival is known
};

}  // namespace ifog::framing
