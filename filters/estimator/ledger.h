// SPDX-License-Identifier: Apache-2.0
// Keeps the angle: what the published rate has fallen short of the measured one, integrated, is paid back.
//
// At rest nothing is booked: a settled filter of gain K owes T (1 - K) / K times the change of rate, and gets it back
// by itself when the rate returns. What a manoeuvre owes is paid within half the samples that its followers look back
// on: paid over n samples, shortfalls of a tracker of memory M at the frequency w turn 2 (w M)^3 w n of a cone into
// drift. What came together before the manoeuvre was found is paid over as many samples as it came together in, as
// paid at once it would put the rate off by more than the motion did. At rest the rate of payment is at most a part
// of the filter's own standard deviation.
#pragma once

#include <algorithm>
#include <cmath>

#include "filters/estimator/lanes.h"

namespace ifog {

class Ledger {
 public:
  explicit Ledger(double period_s) noexcept : period_s_(period_s) {}

  // Rate to be added to this sample's; at rest no more than that part of sqrt(variance).
  [[nodiscard]] Lanes payment(bool moving, const Lanes& rest_variance) noexcept {
    paid_late_ = late_ / (late_pace_ * period_s_);
    Lanes owed = debt_ / (pace_ * period_s_) + paid_late_;
    if (!moving) {
      const Lanes most = kRestShare * rest_variance.sqrt();
      const Lanes limited = owed.max(-most).min(most);
      paid_late_ *= (owed != 0.0).select(limited / owed, Lanes::Zero());
      owed = limited;
    }
    return owed;
  }
  // One sample of dt: angle by which the output without payment fell short of the measured rate, and the payment.
  void book(const Lanes& short_by_rad, const Lanes& paid, double dt_s) noexcept {
    late_ -= paid_late_ * dt_s;
    debt_ += short_by_rad - (paid - paid_late_) * dt_s;
  }
  void owe(const Lanes& angle_rad) noexcept {
    debt_ += angle_rad;
    pace_ = std::max(pace_, kOwedSamples);
  }
  // A manoeuvre was found that has gone on for so many samples.
  void owe_late(const Lanes& angle_rad, double samples) noexcept {
    late_ += angle_rad;
    late_pace_ = samples;
  }
  void add(const Lanes& angle_rad) noexcept { debt_ += angle_rad; }
  void pace(double samples) noexcept { pace_ = std::max(kQuickest, kShare * samples); }
  [[nodiscard]] Lanes owed() const noexcept { return debt_ + late_; }
  void forget() noexcept { debt_ = late_ = Lanes::Zero(); }

 private:
  // Of the filter's standard deviation: 2 % of its variance.
  static constexpr double kRestShare = 0.13;
  static constexpr double kQuickest = 16.0, kShare = 0.5;  // samples; of the followers' length
  static constexpr double kOwedSamples = 1024.0;           // another filter's debt

  double period_s_, pace_ = kQuickest, late_pace_ = kQuickest;
  Lanes debt_ = Lanes::Zero(), late_ = Lanes::Zero(), paid_late_ = Lanes::Zero();
};

}  // namespace ifog
