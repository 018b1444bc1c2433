// SPDX-License-Identifier: Apache-2.0
// A device's time stamp, carried on over its wraps: the time that one stands for, as a proposal. Whoever
// knows whether the frame is used says so, and only then a round is counted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "drivers/ifog/arrivals.h"

namespace ifog {

class RollingStamp {
 public:
  // A stamp, in ns, that begins again after wrap_ns; 0: never.
  struct Stamp {
    std::int64_t ns = 0, wrap_ns = 0;
  };

  // elapsed_s: since the last stamp that was taken, by arrival; negative: not known. period_s: of the
  // samples; 0: not known. Before the last one where that is nearer, or where nothing is known and it is
  // little or more than a device is silent for.
  [[nodiscard]] std::int64_t look(const Stamp& stamp, double elapsed_s, double period_s,
                                  double quiet_s) const noexcept {
    if (!started_) return stamp.ns;
    if (stamp.wrap_ns <= 0) return after(ns_between(last_ns_, stamp.ns));
    std::int64_t step = (stamp.ns - last_ns_) % stamp.wrap_ns;
    if (step < 0) step += stamp.wrap_ns;
    const double step_s = static_cast<double>(step) * 1e-9,
                 wrap_s = static_cast<double>(stamp.wrap_ns) * 1e-9;
    if (step_s > 0.5 * wrap_s && goes_back(step_s, wrap_s, elapsed_s, period_s))
      return after(step - stamp.wrap_ns);
    const double rounds = rounds_behind(step_s, wrap_s, std::min(elapsed_s, quiet_s), period_s);
    return after(step + static_cast<std::int64_t>(rounds) * stamp.wrap_ns);
  }
  void take(const Stamp& stamp, std::int64_t time_ns) noexcept {
    last_ns_ = stamp.ns;
    time_ns_ = time_ns;
    started_ = true;
  }
  [[nodiscard]] std::int64_t time_ns() const noexcept { return time_ns_; }

 private:
  [[nodiscard]] std::int64_t after(std::int64_t step) const noexcept {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns_) + static_cast<std::uint64_t>(step));
  }
  static bool goes_back(double step_s, double wrap_s, double elapsed_s, double period_s) noexcept {
    constexpr double kSamples = 64.0, kNoPause_s = 60.0;
    const double back_s = wrap_s - step_s;
    if (elapsed_s >= 0.0) return elapsed_s + back_s < std::abs(step_s - elapsed_s);
    return back_s <= std::min(kSamples * period_s, 0.25 * wrap_s) || wrap_s >= 2.0 * kNoPause_s;
  }
  // Whole rounds beside the part of one that the step shows: behind a silence, or where that part is a gap,
  // as many as the times of arrival tell. What is only late is behind neither.
  static double rounds_behind(double step_s, double wrap_s, double elapsed_s, double period_s) noexcept {
    constexpr double kSilence_s = 2.0, kGap = 1.5, kClocksApart = 1e-3;
    const bool gap = period_s > 0.0 && step_s > kGap * period_s;
    if (elapsed_s <= kSilence_s && !gap) return 0.0;
    const double rounds =
        whole_rounds(elapsed_s - step_s, wrap_s, kPrompt_s + kClocksApart * elapsed_s, kAdapter_s);
    constexpr double kMost_s = 9e9;  // what an int64 of nanoseconds holds
    return rounds * wrap_s < kMost_s ? rounds : 0.0;
  }

  bool started_ = false;
  std::int64_t last_ns_ = 0, time_ns_ = 0;
};

}  // namespace ifog
