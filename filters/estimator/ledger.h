// SPDX-License-Identifier: Apache-2.0
// Keeps the angle: what the published rate has fallen short of the measured one, integrated, is paid back.
//
// Every sample's shortfall goes to exactly one account, and leaves it by payment only:
//   debt    of a manoeuvre
//   late    what came together before the manoeuvre was found
//   tail    of a filter at rest that has not settled since it was moved
//   doubt   of outliers, until the next measurements show whether they were rotation
// A settled filter of gain K owes T (1 - K) / K times the change of rate and gets it back by itself when the
// rate returns. That is carried by the filter, and so is the angle of an outlier at rest. Once a manoeuvre is
// found what of it was carried since that began is late.
//
// Paid over n samples, shortfalls of a tracker of memory M at the frequency w turn 2 (w M)^3 w n of a cone
// into drift. So a manoeuvre's debt is paid within half of what its followers look back on. What is late is
// paid over as many samples as it came together in: at once it would put the rate off by more than the motion
// did. Of the tail no more is paid than a part of the filter's own standard deviation.
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

  // Rate to be added to this sample's. most: of what is paid of the tail; lag: of the filter at rest, samples; dt_s: of
  // the angle that is integrated with it, by axis.
  [[nodiscard]] Lanes pay(const Lanes& most, double lag, const Lanes& dt_s) noexcept {
    if ((debt_.abs() + late_.abs() + tail_.abs() < kNothing).all()) return Lanes::Zero();
    const Lanes debt = debt_ / dt_s.max(pace_ * period_s_), late = late_ / dt_s.max(late_pace_ * period_s_);
    const Lanes tail = (tail_ / dt_s.max(std::max(kQuickest, lag) * period_s_)).max(-most).min(most);
    debt_ -= debt * dt_s;
    late_ -= late * dt_s;
    tail_ -= tail * dt_s;
    return debt + late + tail;
  }
  // One sample's angle by which the rate without payments fell short of the measured one.
  void book(const Lanes& short_by_rad, Account account) noexcept {
    if (account == Account::kDebt) debt_ += short_by_rad;
    if (account == Account::kTail) tail_ += short_by_rad;
    if (account == Account::kDoubt) doubt_ += short_by_rad;
    if (account == Account::kTail || account == Account::kCarried) at_rest_ += short_by_rad;
  }
  // The outliers were rotation.
  void admit() noexcept { debt_ += std::exchange(doubt_, Lanes::Zero()); }
  // A usual measurement at rest: the outliers before it were none, the less in doubt the longer ago.
  void dismiss() noexcept {
    const Lanes dismissed = doubt_ / kShortGap;
    doubt_ -= dismissed;
    at_rest_ += dismissed;
  }
  // What the filter at rest has fallen short of since this was asked last.
  [[nodiscard]] Lanes take_short_at_rest() noexcept { return std::exchange(at_rest_, Lanes::Zero()); }
  // Another filter's debt.
  void owe(const Lanes& angle_rad) noexcept {
    debt_ += angle_rad;
    pace_ = std::max(pace_, kOwedSamples);
  }
  // A manoeuvre was found that has gone on for so many samples. settled: the filter at rest carried the angle.
  void owe_late(const Lanes& angle_rad, double samples, bool settled) noexcept {
    late_ += angle_rad;
    if (!settled) tail_ -= angle_rad;
    late_pace_ = std::max(kQuickest, samples);
  }
  // Samples that the followers of a manoeuvre look back on.
  void pace(double followers) noexcept { pace_ = pace_of(followers); }
  // Samples over which their debt is paid.
  [[nodiscard]] static double pace_of(double followers) noexcept {
    return std::max(kQuickest, 0.5 * followers);
  }
  [[nodiscard]] Lanes owed() const noexcept { return debt_ + late_ + tail_ + doubt_; }

 private:
  static constexpr double kQuickest = 16.0, kOwedSamples = 1024.0;  // samples
  static constexpr double kNothing = 1e-18;                         // rad: what is less stays owed

  double period_s_, pace_ = kQuickest, late_pace_ = kQuickest;
  Lanes debt_ = Lanes::Zero(), late_ = Lanes::Zero(), tail_ = Lanes::Zero(), doubt_ = Lanes::Zero(),
        at_rest_ = Lanes::Zero();
};

}  // namespace ifog
