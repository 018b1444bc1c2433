// SPDX-License-Identifier: Apache-2.0
// Time of a sample from its number: a line through arrival times over the sequence counter. Arrival times
// jitter by scheduling; the counter does not, and the device's quartz drifts slowly against the computer's.
//
// Growing-memory least squares (E. Brookner, "Tracking and Kalman Filtering Made Easy", 1998, section 1.2.10:
// g-h gains 2(2n+1)/((n+1)(n+2)) and 6/((n+1)(n+2))) up to `memory` samples, then fixed gains to follow
// drift. No sample arrives before it was measured. If samples arrive before the line, it started with a
// delayed sample and restarts.
#pragma once

#include <cstdint>

namespace ifog {

class FittedClock {
 public:
  // nominal_period_s > 0. memory: samples, ≥ 2.
  FittedClock(double nominal_period_s, int memory) noexcept;

  // Advances by `periods` nominal periods and returns the fitted time, ns since the epoch (since 0 if there
  // was never an arrival time). arrival_ns <= 0: no arrival time, the line is extrapolated.
  std::int64_t advance(double periods, std::int64_t arrival_ns) noexcept;
  // To be called after a gap: the next arrival starts a new line; the fitted period is kept.
  void restart() noexcept { fitted_ = 0; }

  [[nodiscard]] double period_s() const noexcept { return period_ns_ * 1e-9; }
  [[nodiscard]] bool settled() const noexcept { return fitted_ >= memory_; }
  // Mean distance of arrivals from the line.
  [[nodiscard]] double spread_s() const noexcept { return spread_ns_ * 1e-9; }
  // Arrival − line for the next sample after `periods`, s; 0 before the first.
  [[nodiscard]] double lateness_s(double periods, std::int64_t arrival_ns) const noexcept;

 private:
  [[nodiscard]] bool overtaken(std::int64_t arrival_ns) const noexcept;

  double nominal_ns_;
  double period_ns_;
  // Keeps time_ns_ small; ns since the epoch in a double have a resolution of 256 ns
  std::int64_t origin_ns_ = 0;
  double time_ns_ = 0.0;     // of the last sample, relative to origin
  double counted_ns_ = 0.0;  // since the start of the line, at the nominal period
  double spread_ns_ = 0.0;   // running mean of |arrival − line|
  std::int64_t memory_;
  std::int64_t fitted_ = 0;  // samples in the line
};

}  // namespace ifog
