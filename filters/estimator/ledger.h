// SPDX-License-Identifier: Apache-2.0
// Keeps the angle: what the published rate has fallen short of the measured one, integrated, is paid back.
//
// At rest nothing is booked: a settled filter of gain K owes T (1 - K) / K times the change of rate, and gets
// it back by itself when the rate returns. What a manoeuvre owes is paid within half the samples that its
// followers look back on: paid over n samples, shortfalls of a tracker of memory M at the frequency w turn 2
// (w M)^3 w n of a cone into drift. What came together before the manoeuvre was found is paid over as many
// samples as it came together in, as paid at once it would put the rate off by more than the motion did. A
// filter at rest that was moved is a mean of what came since, and nothing that it lags behind by returns by
// itself: until it has settled that is booked, too, and paid at no more than a part of its own standard
// deviation.
#pragma once

#include <algorithm>
#include <cmath>

#include "filters/estimator/lanes.h"

namespace ifog {

class Ledger {
 public:
  explicit Ledger(double period_s) noexcept : period_s_(period_s) {}

  // Rate to be added to this sample's. Of what is owed at rest no more than that part of sqrt(variance) a
  // sample. dt_s: of the angle that is integrated with it, by axis.
  [[nodiscard]] Lanes payment(const Lanes& rest_variance, bool limited, const Lanes& dt_s) noexcept {
    paid_late_ = late_ / dt_s.max(late_pace_ * period_s_);
    paid_slow_ = slow_ / dt_s.max(slow_pace_ * period_s_);
    if (limited) {
      const Lanes most = kRestShare * rest_variance.sqrt();
      paid_slow_ = paid_slow_.max(-most).min(most);
    }
    return debt_ / dt_s.max(pace_ * period_s_) + paid_late_ + paid_slow_;
  }
  // One sample of dt: angle by which the output without payment fell short of the measured rate, in a
  // manoeuvre or in a filter at rest of which nothing returns by itself, and the payment.
  void book(const Lanes& short_by_rad, bool manoeuvre, const Lanes& paid, const Lanes& dt_s) noexcept {
    debt_ -= (paid - paid_late_ - paid_slow_) * dt_s;
    late_ -= paid_late_ * dt_s;
    slow_ -= paid_slow_ * dt_s;
    (manoeuvre ? debt_ : slow_) += short_by_rad;
  }
  // Samples over which what is owed at rest is paid.
  void slow_pace(double samples) noexcept { slow_pace_ = std::max(kSlowest, samples); }
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
  [[nodiscard]] Lanes owed() const noexcept { return debt_ + late_ + slow_; }
  void forget() noexcept { debt_ = late_ = slow_ = Lanes::Zero(); }

 private:
  // Of the filter's standard deviation: a tenth of its variance, and the tail of a manoeuvre is paid within
  // ten lags.
  static constexpr double kRestShare = 0.3;
  static constexpr double kQuickest = 16.0, kShare = 0.5;  // samples; of the followers' length
  static constexpr double kOwedSamples = 1024.0;           // another filter's debt

  static constexpr double kSlowest = 100.0;

  double period_s_, pace_ = kQuickest, late_pace_ = kQuickest, slow_pace_ = kSlowest;
  Lanes debt_ = Lanes::Zero(), late_ = Lanes::Zero(), slow_ = Lanes::Zero();
  Lanes paid_late_ = Lanes::Zero(), paid_slow_ = Lanes::Zero();
};

}  // namespace ifog
