// SPDX-License-Identifier: Apache-2.0
// Device clock whose tick is not much shorter than a sample: without losses its steps are none, one or two
// ticks, and only their sum is accurate. Samples are spaced at the nominal period, and the sum stays within
// two ticks of the clock.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <numeric>

#include "drivers/timeline/sample_pace.h"

namespace ifog {

class Ticks {
 public:
  struct Step {
    std::uint64_t samples = 1;
    double dt_s = 0.0;
  };

  explicit Ticks(double nominal_s) noexcept : nominal_s_(nominal_s) {}
  // The clock was set or restarted: its sum starts again, its tick is kept.
  void jumped() noexcept { owed_s_ = 0.0; }
  // It has stood still between two samples.
  [[nodiscard]] bool stood() const noexcept { return stood_; }
  [[nodiscard]] bool known() const noexcept { return stood_ || tick_ns_ > 0; }
  // Resolution of one step; at most a second before a tick was seen.
  [[nodiscard]] double grain_s() const noexcept { return !stood_ ? 0.0 : tick_ns_ == 0 ? 1.0 : tick_s(); }
  // True if another sample with the same stamp and values is possible.
  [[nodiscard]] bool has_room() const noexcept { return stood_ && owed_s_ > -2.0 * tick_s(); }

  // passed_ns >= 0: since the previous sample; counted: samples by the counter, 0: none.
  [[nodiscard]] Step take(std::int64_t passed_ns, std::uint64_t counted) noexcept {
    const double passed_s = static_cast<double>(passed_ns) * 1e-9;
    learn(passed_ns, passed_s);
    owed_s_ = coarse() ? owed_s_ + passed_s : passed_s;
    const double samples = (owed_s_ - (stood_ ? 1.0 : 0.25) * tick_s()) / nominal_s_;
    Step step{counted > 0 ? counted : SamplePace::at_least_one(samples), owed_s_};
    if (coarse()) {
      const double slack_s = tick_ns_ > 0 ? 2.0 * tick_s() : HUGE_VAL;
      step.dt_s = std::clamp(static_cast<double>(step.samples) * nominal_s_, owed_s_ - slack_s,
                             std::max(owed_s_ + slack_s, 0.05 * nominal_s_));
    }
    owed_s_ -= step.dt_s;
    return step;
  }

 private:
  static constexpr int kProof = 32;     // number of steps that confirm the tick
  static constexpr double kFine = 4.0;  // ticks per period

  [[nodiscard]] double tick_s() const noexcept { return static_cast<double>(tick_ns_) * 1e-9; }
  [[nodiscard]] bool coarse() const noexcept {
    const double ticks = tick_ns_ > 0 && steps_ >= kProof ? nominal_s_ / tick_s() : 0.0;
    return stood_ || (ticks >= 1.0 && ticks < kFine && std::abs(ticks - std::round(ticks)) > 1e-7);
  }
  // A step over missing samples is a multiple of the tick, too. A longer one may be a clock that was set.
  void learn(std::int64_t passed_ns, double passed_s) noexcept {
    stood_ = stood_ || passed_ns == 0;
    if (passed_ns == 0 || passed_s > kFine * std::max(nominal_s_, tick_ns_ > 0 ? tick_s() : 1.0)) return;
    const std::int64_t tick_ns = std::gcd(tick_ns_, passed_ns);
    steps_ = tick_ns == tick_ns_ ? std::min(steps_ + 1, kProof) : 1;
    tick_ns_ = tick_ns;
  }

  double nominal_s_;
  std::int64_t tick_ns_ = 0;
  int steps_ = 0;
  bool stood_ = false;
  double owed_s_ = 0.0;  // the clock's sum minus the published intervals
};

}  // namespace ifog
