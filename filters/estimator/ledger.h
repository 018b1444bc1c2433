// SPDX-License-Identifier: Apache-2.0
// Conserves the angle: the integrated difference between measured and published rate is paid back.
//
// Each sample's difference is booked to exactly one account and leaves it only by payment:
//   debt    of a manoeuvre
//   late    accumulated before the manoeuvre was detected
//   tail    of a filter at rest that has not settled since it was reset
//   doubt   of outliers, until the next measurements show whether they were rotation
// The lag of a settled filter is not booked, nor is the angle of an outlier at rest. README.md says over which time
// each account is paid: payment over n samples of a tracker of memory M turns 2 (w M)^3 w n of a cone of frequency w
// into drift.
#pragma once

#include <algorithm>
#include <cmath>
#include <utility>

#include "filters/estimator/sample.h"

namespace ifog {

class Ledger {
 public:
  enum class Account { kDebt, kTail, kDoubt, kCarried };
  explicit Ledger(double period_s) noexcept : period_s_(period_s) {}

  // Rate to be added to this sample's. most: limit of the tail's payment; lag: of the filter at rest,
  // samples; dt_s: integration time of the rate, by axis.
  [[nodiscard]] Lanes pay(const Lanes& most, double lag, const Lanes& dt_s) noexcept {
    if ((debt_.abs() + late_.abs() + tail_.abs() < kNothing).all()) return Lanes::Zero();
    const Lanes debt = debt_ / dt_s.max(pace_ * period_s_), late = late_ / dt_s.max(late_pace_ * period_s_);
    const Lanes tail = (tail_ / dt_s.max(std::max(kQuickest, lag) * period_s_)).max(-most).min(most);
    debt_ -= debt * dt_s;
    late_ -= late * dt_s;
    tail_ -= tail * dt_s;
    return debt + late + tail;
  }
  // Books one sample's angle: measured minus published rate (without payments), integrated.
  void book(const Lanes& short_by_rad, Account account) noexcept {
    if (account == Account::kDebt) debt_ += short_by_rad;
    if (account == Account::kTail) tail_ += short_by_rad;
    if (account == Account::kDoubt) doubt_ += short_by_rad;
    if (account == Account::kTail || account == Account::kCarried) at_rest_ += short_by_rad;
  }
  // The outliers were rotation.
  void admit() noexcept { debt_ += std::exchange(doubt_, Lanes::Zero()); }
  // A normal measurement at rest: the outliers before were no rotation.
  void dismiss() noexcept { at_rest_ += std::exchange(doubt_, Lanes::Zero()); }
  // Angle error of the filter at rest since the last call.
  [[nodiscard]] Lanes shortfall_at_rest() noexcept { return std::exchange(at_rest_, Lanes::Zero()); }
  // Takes over another filter's debt.
  void owe(const Lanes& angle_rad) noexcept {
    debt_ += angle_rad;
    pace_ = std::max(pace_, kOwedSamples);
  }
  // A manoeuvre was detected that began `samples` ago. settled: the filter at rest would have recovered the
  // angle.
  void owe_late(const Lanes& angle_rad, double samples, bool settled) noexcept {
    late_ += angle_rad;
    if (!settled) tail_ -= angle_rad;
    late_pace_ = std::max(kQuickest, samples);
  }
  // followers: memory of the manoeuvre's trackers, samples.
  void pace(double followers) noexcept { pace_ = pace_of(followers); }
  // Samples over which the debt is paid.
  [[nodiscard]] static double pace_of(double followers) noexcept {
    return std::max(kQuickest, 0.5 * followers);
  }
  [[nodiscard]] Lanes owed() const noexcept { return debt_ + late_ + tail_ + doubt_; }

 private:
  static constexpr double kQuickest = 16.0, kOwedSamples = 1024.0;  // samples
  static constexpr double kNothing = 1e-18;                         // rad; smaller debts are not paid

  double period_s_, pace_ = kQuickest, late_pace_ = kQuickest;
  Lanes debt_ = Lanes::Zero(), late_ = Lanes::Zero(), tail_ = Lanes::Zero(), doubt_ = Lanes::Zero(),
        at_rest_ = Lanes::Zero();
};

}  // namespace ifog
