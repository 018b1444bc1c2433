// SPDX-License-Identifier: Apache-2.0
// Time of a sample from its number: a line through arrival times against the sequence counter. Arrival times
// jitter by scheduling, the device's counter does not, and its quartz differs from the computer's by a slowly
// moving factor.
//
// Growing-memory least squares (E. Brookner, "Tracking and Kalman Filtering Made Easy", 1998, section 1.2.10:
// g-h gains 2(2n+1)/((n+1)(n+2)) and 6/((n+1)(n+2))) up to `memory` samples, then with fixed gains, which
// follows drift. No sample arrives before it was measured: a line that later samples precede began with a delayed
// sample, and restarts.
#pragma once

#include <cstdint>

namespace ifog {

class FittedClock {
 public:
  // nominal_period_s > 0. memory: samples, ≥ 2.
  FittedClock(double nominal_period_s, int memory) noexcept;

  // Advances by so many nominal periods of the device. arrival_ns ≤ 0: no arrival time, the line is only
  // continued. Returns the fitted time, ns since the epoch (since 0 when no arrival time was ever known).
  std::int64_t advance(double periods, std::int64_t arrival_ns) noexcept;
  // After a gap: the next arrival starts a new line; the fitted period is kept.
  void restart() noexcept { fitted_ = 0; }

  [[nodiscard]] double period_s() const noexcept { return period_ns_ * 1e-9; }
  [[nodiscard]] bool settled() const noexcept { return fitted_ >= memory_; }
  // What arrivals scatter by about the line, mean.
  [[nodiscard]] double spread_s() const noexcept { return spread_ns_ * 1e-9; }
  // Arrival − line for the next sample if `periods` have passed, s; 0 before the first.
  [[nodiscard]] double lateness_s(double periods, std::int64_t arrival_ns) const noexcept;

 private:
  [[nodiscard]] bool overtaken(std::int64_t arrival_ns) const noexcept;

  double nominal_ns_;
  double period_ns_;
  std::int64_t origin_ns_ = 0;  // keeps time_ns_ small: a double of ns since the epoch has a grain of 256 ns
  double time_ns_ = 0.0;        // of the last sample, after origin
  double counted_ns_ = 0.0;     // since the line began, at the nominal period
  double spread_ns_ = 0.0;      // running mean of |arrival − line|
  std::int64_t memory_;
  std::int64_t fitted_ = 0;  // samples in the line
};

}  // namespace ifog
