// SPDX-License-Identifier: Apache-2.0
// Rate in Hz from a counter that is read from time to time: from the last reading if it grew by many, else
// over the last ten events.
#pragma once

#include <cstdint>

namespace ifog {

class CountedRate {
 public:
  // count: not decreasing; interval_s: since the previous reading, > 0; expected_hz > 0.
  double of(std::int64_t count, double interval_s, double expected_hz) noexcept {
    const auto more = static_cast<double>(count - last_count_);
    last_count_ = count;
    if (expected_hz * interval_s >= kMany) return more / interval_s;
    since_s_ += interval_s;
    quiet_s_ += interval_s;
    counted_ += more;
    if (more > 0.0) {
      // Average between arrivals; needs 10 samples except before the first estimate.
      const bool many = counted_ >= kMany;
      if (!known_ || many) rate_hz_ = began_ ? counted_ / since_s_ : more / quiet_s_;
      if (!began_ || many) counted_ = since_s_ = 0.0;
      known_ = known_ || (began_ && many);
      began_ = true;
      quiet_s_ = 0.0;
    } else if (quiet_s_ * expected_hz > kSilent && quiet_s_ > 2.0) {
      rate_hz_ = counted_ = since_s_ = 0.0;
      began_ = known_ = false;
    }
    return rate_hz_;
  }

 private:
  static constexpr double kMany = 10.0;
  static constexpr double kSilent = 3.0;  // periods without an event after which the rate is zero

  std::int64_t last_count_ = 0;
  double counted_ = 0.0, since_s_ = 0.0, quiet_s_ = 0.0, rate_hz_ = 0.0;
  bool began_ = false, known_ = false;
};

}  // namespace ifog
