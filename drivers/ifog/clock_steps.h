// SPDX-License-Identifier: Apache-2.0
// Samples and time from the steps of a device's own clock, also of one that ticks hardly more often than the
// device samples: its steps then are none, one or two ticks though nothing is lost, and only its sum says how
// much has passed.
//
// A device without a counter whose tick is as long as its stated period says the same where it samples 1.4 %
// more slowly and where it loses one of 70: one step in 70 is of two ticks. It is taken for a loss: what is
// told has passed either way, and no angle is made for a sample that may not have been.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "drivers/ifog/arrivals.h"

namespace ifog {

class ClockSteps {
 public:
  struct Step {
    std::uint64_t samples = 1;
    double dt_s = 0.0;
  };

  // nominal_s > 0.
  explicit ClockSteps(double nominal_s) noexcept : nominal_s_(nominal_s) {}
  // The device was switched off and on. How its clock ticks is as it was.
  void restart() noexcept { jumped(); }

  // passed_ns >= 0. counted: samples by the device's counter; 0: it has none.
  Step take(std::int64_t passed_ns, std::uint64_t counted) noexcept {
    const double passed_s = static_cast<double>(passed_ns) * 1e-9;
    if (passed_ns == 0) stood_ = true;
    // The first time it moves after it stood says nothing: where between two ticks it began nobody knows.
    const bool first_tick = stood_ && tick_ns_ == 0;
    if (passed_ns > 0) ticked(passed_ns);
    // What a tick leaves open is no sample that is missing: all of it where several have one stamp.
    const double rounded_s = (stood_ ? 1.0 : kRounded) * static_cast<double>(tick_ns_) * 1e-9;
    if (!coarse()) {
      time_s_ = counted_s_ = 0.0;
      samples_ = 0.0;
      return {counted > 0 ? counted : at_least_one((passed_s - rounded_s) / nominal_s_), passed_s};
    }
    const double period_s = this->period_s();
    const double ahead_s = time_s_ - counted_s_ + passed_s;
    Step step;
    if (counted > 0)
      step.samples = counted;
    else if (!first_tick)
      step.samples = at_least_one((ahead_s - rounded_s) / period_s);
    // Whatever the nominal period is: what is told stays by the clock's own sum.
    const double slack_s = tick_ns_ > 0 ? kSlack * static_cast<double>(tick_ns_) * 1e-9 : HUGE_VAL;
    step.dt_s = std::clamp(static_cast<double>(step.samples) * period_s, ahead_s - slack_s,
                           std::max(ahead_s + slack_s, kLeast * nominal_s_));
    time_s_ += passed_s;
    counted_s_ += step.dt_s;
    samples_ += static_cast<double>(step.samples);
    return step;
  }
  // It was set: the step before this one is none of its own.
  void jumped() noexcept { time_s_ = counted_s_ = samples_ = 0.0; }
  // Several samples have one stamp, as how it went on behind them has shown.
  void stands() noexcept { stood_ = true; }
  // It has been seen to move, or to stand.
  [[nodiscard]] bool known() const noexcept { return stood_ || steps_ > 0; }
  // To what a single step says how much has passed.
  [[nodiscard]] double grain_s() const noexcept {
    constexpr double kSlowest_s = 1.0;  // while no tick is known
    return !stood_ ? 0.0 : tick_ns_ == 0 ? kSlowest_s : static_cast<double>(tick_ns_) * 1e-9;
  }
  // Its single steps say less than the period does.
  [[nodiscard]] bool coarse() const noexcept {
    if (stood_) return true;
    if (steps_ < kProof) return false;
    const double ticks = nominal_s_ * 1e9 / static_cast<double>(std::max<std::int64_t>(tick_ns_, 1));
    // One that ticks less often than the device samples stands now and then: the nominal rate is another one.
    if (ticks < 1.0) return false;
    const bool beats = std::abs(ticks - std::round(ticks)) > kBeat;
    return ticks < kFine && beats;
  }
  [[nodiscard]] bool stood() const noexcept { return stood_; }
  // Samples with one stamp, generously; while no tick is known, as many as the coarsest clock may have.
  [[nodiscard]] std::uint64_t most_in_a_tick() const noexcept {
    constexpr std::uint64_t kUnknown = 1000;
    const double samples = 2.0 * static_cast<double>(tick_ns_) * 1e-9 / nominal_s_ + 2.0;
    return tick_ns_ > 0 && samples < 1e9 ? static_cast<std::uint64_t>(samples) : kUnknown;
  }

 private:
  static constexpr double kFine = 4.0;       // ticks a period
  static constexpr int kProof = 32;          // steps without a finer one
  static constexpr double kBeat = 1e-7;      // of a tick
  static constexpr double kSlack = 2.0;      // ticks that the sum of what is told may be beside the clock's
  static constexpr double kLeast = 0.05;     // of the nominal period: a sample takes some time
  static constexpr double kNear = 4.0;       // periods or ticks: a longer step may be behind a silence
  static constexpr double kRounded = 0.25;   // of a tick
  static constexpr double kUnknown_s = 1.0;  // that a tick may have
  static constexpr int kOdd = 3;             // steps that fit no tick, and it is a finer one

  // One step that fits none is a clock that was set, or begun anew unseen: it says nothing of the ticks.
  void ticked(std::int64_t passed_ns) noexcept {
    const double tick_s = tick_ns_ > 0 ? static_cast<double>(tick_ns_) * 1e-9 : kUnknown_s;
    if (static_cast<double>(passed_ns) * 1e-9 > kNear * std::max(nominal_s_, tick_s)) return;
    steps_ = std::min(steps_ + 1, kProof);
    if (tick_ns_ == 0) {
      tick_ns_ = passed_ns;
    } else if (passed_ns % tick_ns_ != 0) {
      odd_ns_ = std::gcd(odd_ns_, passed_ns);
      if (++odd_ < kOdd) return;
      tick_ns_ = std::gcd(tick_ns_, odd_ns_);
      odd_ns_ = 0;
      odd_ = steps_ = 0;
    }
  }

  // The nominal one, as far as the sum of the steps allows, which is known to a tick. Else what they took,
  // and so much more or less that what is told comes to the middle of what the ticks leave open.
  [[nodiscard]] double period_s() const noexcept {
    constexpr double kSamples = 256.0;  // in which it comes there
    if (samples_ < 1.0 || tick_ns_ == 0) return nominal_s_;
    const double tick_s = static_cast<double>(tick_ns_) * 1e-9;
    if (std::abs(samples_ * nominal_s_ - time_s_) <= tick_s) return nominal_s_;
    return std::max(0.5 * nominal_s_, time_s_ / samples_ + (time_s_ - counted_s_) / kSamples);
  }

  double nominal_s_;
  std::int64_t tick_ns_ = 0;  // that all steps but a few are multiples of
  std::int64_t odd_ns_ = 0;   // that those few are multiples of
  int odd_ = 0, steps_ = 0;
  bool stood_ = false;
  double time_s_ = 0.0, counted_s_ = 0.0, samples_ = 0.0;  // since the clock is known to be coarse
};

}  // namespace ifog
