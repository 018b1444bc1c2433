// SPDX-License-Identifier: Apache-2.0
// A device's time stamp, carried on over its wraps: the time that one stands for, as a proposal. Whoever
// knows whether the frame is used says so, and only then a round is counted.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "drivers/ifog/arrivals.h"

namespace ifog {

class RollingStamp {
 public:
  // A stamp, in ns, that begins again after wrap_ns; 0: never.
  struct Stamp {
    std::int64_t ns = 0, wrap_ns = 0;
  };

  // What is known of the time from the last stamp that was taken to the next.
  struct Between {
    double elapsed_s = -1.0;            // by arrival; negative: not known
    double period_s = 0.0;              // of the samples; 0: not known
    double quiet_s = -1.0;              // since any came, by arrival; negative: not known
    std::optional<double> counted_s{};  // by the device's counter; none: it has none, or does not tell
    double count_round_s = 0.0;         // in which that goes round; 0: it does not
  };
  // As far on as the counter says, where the stamp fits that. Else before the last one where that is nearer,
  // or where nothing is known and it is little or more than a device is silent for; but never where it is on
  // by hardly more than a sample takes.
  [[nodiscard]] std::int64_t look(const Stamp& stamp, const Between& between) const noexcept {
    if (!started_) return stamp.ns;
    if (stamp.wrap_ns <= 0) return after(ns_between(last_ns_, stamp.ns));
    std::int64_t step = ns_between(last_ns_, stamp.ns) % stamp.wrap_ns;
    if (step < 0) step += stamp.wrap_ns;
    const double step_s = static_cast<double>(step) * 1e-9,
                 wrap_s = static_cast<double>(stamp.wrap_ns) * 1e-9;
    const std::optional<double> counted = rounds_counted(step_s, wrap_s, between);
    if (counted) return after(step, static_cast<std::int64_t>(*counted), stamp.wrap_ns);
    if (step_s > std::max(0.5 * wrap_s, kGap * between.period_s) && goes_back(step_s, wrap_s, between))
      return after(step - stamp.wrap_ns);
    const double rounds =
        rounds_behind(step_s, wrap_s, std::min(between.elapsed_s, between.quiet_s), between.period_s);
    return after(step, static_cast<std::int64_t>(rounds), stamp.wrap_ns);
  }
  void take(const Stamp& stamp, std::int64_t time_ns) noexcept {
    last_ns_ = stamp.ns;
    time_ns_ = time_ns;
    started_ = true;
  }
  [[nodiscard]] std::int64_t time_ns() const noexcept { return time_ns_; }

 private:
  static constexpr double kGap = 1.5;  // periods: more are not one sample's
  static constexpr double kSilence_s = 2.0;
  static constexpr double kMost_s = 9e9;  // what an int64 of nanoseconds holds

  // Whatever a device says: what has no room wraps.
  [[nodiscard]] std::int64_t after(std::int64_t step, std::int64_t rounds = 0,
                                   std::int64_t wrap_ns = 0) const noexcept {
    return static_cast<std::int64_t>(static_cast<std::uint64_t>(time_ns_) + static_cast<std::uint64_t>(step) +
                                     static_cast<std::uint64_t>(rounds) *
                                         static_cast<std::uint64_t>(wrap_ns));
  }
  // Whole rounds to where the counter says; none: they do not fit. Behind a silence the counter may have gone
  // round as well: those with which whole rounds of both agree, nearest to what the silence was.
  static std::optional<double> rounds_counted(double step_s, double wrap_s, const Between& between) noexcept {
    constexpr double kSamples = 2.0, kDoubt = 0.01, kTells = 0.25;
    if (!between.counted_s) return std::nullopt;
    if (const double silent_s = std::min(between.elapsed_s, between.quiet_s); silent_s > kSilence_s)
      return rounds_of_both(step_s, wrap_s, silent_s, between);
    const double counted_s = *between.counted_s, rounds = std::round((counted_s - step_s) / wrap_s);
    const double slack_s =
        std::min(kSamples * between.period_s + kDoubt * std::abs(counted_s), kTells * wrap_s);
    const bool fits = std::abs(step_s + rounds * wrap_s - counted_s) <= slack_s;
    return fits && rounds * wrap_s < kMost_s ? std::optional(rounds) : std::nullopt;
  }
  static std::optional<double> rounds_of_both(double step_s, double wrap_s, double silent_s,
                                              const Between& between) noexcept {
    constexpr double kSamples = 2.0, kDoubt = 1e-3, kTells = 0.125, kMost = 1000.0;
    const double most = std::floor((silent_s - step_s) / wrap_s + 0.5), count_s = between.count_round_s;
    if (!(count_s > 0.0 && most >= 1.0 && most <= kMost)) return std::nullopt;
    for (double rounds = most; rounds >= 0.0; --rounds) {
      const double passed_s = step_s + rounds * wrap_s, beside_s = passed_s - *between.counted_s;
      const double slack_s = std::min(
          std::min(kSamples * between.period_s, kTells * wrap_s) + kDoubt * passed_s, kTells * count_s);
      const double counts = std::max(0.0, std::round(beside_s / count_s));
      if (std::abs(beside_s - counts * count_s) <= slack_s) return rounds;
    }
    return std::nullopt;
  }
  static bool goes_back(double step_s, double wrap_s, const Between& between) noexcept {
    constexpr double kSamples = 64.0, kNoPause_s = 60.0;
    const double back_s = wrap_s - step_s;
    if (between.elapsed_s >= 0.0) return between.elapsed_s + back_s < std::abs(step_s - between.elapsed_s);
    return back_s <= std::min(kSamples * between.period_s, 0.25 * wrap_s) || wrap_s >= 2.0 * kNoPause_s;
  }
  // Whole rounds beside the part of one that the step shows: behind a silence, or where that part is a gap,
  // as many as the times of arrival tell. What is only late is behind neither.
  static double rounds_behind(double step_s, double wrap_s, double elapsed_s, double period_s) noexcept {
    constexpr double kClocksApart = 1e-3;
    const bool gap = period_s > 0.0 && step_s > kGap * period_s;
    if (elapsed_s <= kSilence_s && !gap) return 0.0;
    const double rounds =
        whole_rounds(elapsed_s - step_s, wrap_s, kPrompt_s + kClocksApart * elapsed_s, kAdapter_s);
    return rounds * wrap_s < kMost_s ? rounds : 0.0;
  }

  bool started_ = false;
  std::int64_t last_ns_ = 0, time_ns_ = 0;
};

}  // namespace ifog
