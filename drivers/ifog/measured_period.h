// SPDX-License-Identifier: Apache-2.0
// What a sample of a device really takes, where the stated rate is only nearly that: by the times of arrival
// and by the device's own clock. A gap ends a run of arrivals, but not what they have shown.
#pragma once

#include <algorithm>
#include <cmath>

namespace ifog {

class MeasuredPeriod {
 public:
  // nominal_s > 0.
  explicit MeasuredPeriod(double nominal_s) noexcept : nominal_s_(nominal_s) {}
  void forget() noexcept { *this = MeasuredPeriod(nominal_s_); }

  // So many samples came in a time by arrival, none missing and none held up.
  void came(double samples, double elapsed_s) noexcept {
    const double counted_s = samples * nominal_s_;
    run_.took_s += elapsed_s;
    run_.counted_s += counted_s;
    run_.jitter_s =
        std::max(kForgets * run_.jitter_s, std::min(std::abs(elapsed_s - counted_s), kMostJitter_s));
  }
  // What comes next does not join what came.
  void broken() noexcept {
    if (run_.measured(nominal_s_) && run_.doubt() + kDrifts <= kept_doubt_) {
      kept_s_ = run_.period_s(nominal_s_);
      kept_doubt_ = run_.doubt() + kDrifts;
    }
    run_ = {};
  }
  // So long they took by the device's clock.
  void ticked(double samples, double passed_s) noexcept {
    clock_samples_ += samples;
    clock_s_ += passed_s;
  }

  [[nodiscard]] double by_arrival_s() const noexcept {
    return now() ? run_.period_s(nominal_s_) : kept_s_ > 0.0 ? kept_s_ : nominal_s_;
  }
  // Of that, the part by which it may be wrong.
  [[nodiscard]] double doubt() const noexcept { return now() ? run_.doubt() : kept_doubt_; }
  // The nominal one, as far as the sum of the clock's steps allows, which is known to a step of it.
  [[nodiscard]] double by_clock_s(double grain_s) const noexcept {
    if (clock_samples_ < 1.0) return nominal_s_;
    const double slack_s = std::max(grain_s, nominal_s_);
    const double period_s =
        std::clamp(nominal_s_, (clock_s_ - slack_s) / clock_samples_, (clock_s_ + slack_s) / clock_samples_);
    return std::clamp(period_s, kLeast * nominal_s_, nominal_s_ / kLeast);
  }

 private:
  // Of the rate that the configuration says, where nothing is measured yet: sample clocks are off by 3 %.
  static constexpr double kRateDoubt = 0.05;
  static constexpr double kLeastDoubt = 2e-5;
  static constexpr double kDrifts = 1e-4;  // of a rate that was measured a while ago
  static constexpr double kEnough = 64.0;  // periods, and the rate is measured
  static constexpr double kForgets = 0.9998;
  static constexpr double kMostJitter_s = 1.0;
  static constexpr double kLeast = 0.5;  // of the nominal period

  struct Run {
    double took_s = 0.0, counted_s = 0.0;  // by arrival, and by the count at the nominal rate
    double jitter_s = 0.0;

    [[nodiscard]] bool measured(double nominal_s) const noexcept {
      return counted_s >= kEnough * nominal_s && took_s > 0.0;
    }
    // The nominal one, as far as what times of arrival scatter by allows.
    [[nodiscard]] double period_s(double nominal_s) const noexcept {
      const double nearest =
          std::clamp(counted_s, std::max(took_s - jitter_s, 0.0), took_s + jitter_s) / counted_s;
      return nominal_s * std::clamp(nearest, kLeast, 1.0 / kLeast);
    }
    [[nodiscard]] double doubt() const noexcept {
      return std::min(kRateDoubt, kLeastDoubt + 2.0 * jitter_s / took_s);
    }
  };
  [[nodiscard]] bool now() const noexcept { return run_.measured(nominal_s_) && run_.doubt() <= kept_doubt_; }

  double nominal_s_;
  Run run_;
  double kept_s_ = 0.0, kept_doubt_ = kRateDoubt;  // of the best run before; 0: none was long enough
  double clock_samples_ = 0.0, clock_s_ = 0.0;
};

}  // namespace ifog
