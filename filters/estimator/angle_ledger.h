// SPDX-License-Identifier: Apache-2.0
// Keeps the angle: what the published rate has fallen short of the measured one, integrated, is paid back.
//
// Three accounts. A settled filter of gain K owes tau (y - y0), tau = T (1-K)/K, and gets it back by itself
// when the rate returns: that is the account at rest, and what it holds beyond that lag is paid, no faster
// than an eighth of the filter's own uncertainty. y0 follows y slowly, so that a rate that does not return
// leaves no debt either; by two poles, as by one it would go along with a slow sea a quarter of a period
// late, which is how the lag goes, and be paid on top of it. In the tail of a motion, while the filter is a
// mean of what came since, nothing comes back by itself: all is paid, over as long as the mean is, no faster
// than that eighth either. What is owed since a change of rate was
// found is the account of the manoeuvre: paid quickly, within half the samples that the followers of the
// motion look back on. Quickly for coning's sake: paid over n samples, shortfalls of a tracker of memory M at
// the frequency w turn 2 (w M)^3 w n of a cone into drift. What came together before it was found has its
// own, and is paid over as many samples as it came together in: of a motion that took thousands to find it
// is a thousand times what one of them is off by, and paid at once puts the rate off by more than the motion
// did. A debt of long rest is never paid quickly, however sharp the manoeuvre that follows: it is not the
// manoeuvre's.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>

#include "filters/settings/axes.h"

namespace ifog {

class AngleLedger {
 public:
  // follows: changes of rate are followed. Where they are not, all debts are the lag's, and have no limit.
  AngleLedger(double period_s, bool follows) : period_s_(period_s), follows_(follows) {}

  // Rates to be added to the output of this sample, for each account; before: what was owed when the change
  // was found.
  struct Payment {
    double quick = 0.0, before = 0.0, slow = 0.0;
    [[nodiscard]] double rate() const noexcept { return quick + before + slow; }
  };
  // rest, variance: rate and variance of the filter at rest; dt_s: what the sample covers.
  [[nodiscard]] Payment payment(std::size_t axis, double rest, double variance, double dt_s) const noexcept {
    const double most = follows_ ? kSlowShare * std::sqrt(variance) : kNoLimit;
    const double beyond = at_rest_[axis] - lag_s_ * (rest - reference_[axis]);
    const double over_s = tail_s_ > 0.0 ? tail_s_ : kSlowLags * lag_s_;
    return {manoeuvre_[axis] / std::max(quick_s_, dt_s), before_[axis] / std::max(before_s_[axis], dt_s),
            std::clamp(beyond / (over_s + kSlowSamples * period_s_), -most, most)};
  }

  // Books one sample: what the filter's own output falls short of the measured rate, times dt, and what was
  // paid with it. Gives what the account at rest has grown by.
  double book(std::size_t axis, double short_by_rad, const Payment& paid, double dt_s, double rest,
              bool manoeuvre) noexcept {
    (manoeuvre ? manoeuvre_ : at_rest_)[axis] += short_by_rad;
    manoeuvre_[axis] -= paid.quick * dt_s;
    before_[axis] -= paid.before * dt_s;
    at_rest_[axis] -= paid.slow * dt_s;
    if (manoeuvre) return -paid.slow * dt_s;
    const double share = dt_s / (kReturnLags * lag_s_ + kReturnSamples * period_s_);
    followed_[axis] += (rest - followed_[axis]) * share;
    reference_[axis] += (followed_[axis] - reference_[axis]) * share;
    return short_by_rad - paid.slow * dt_s;
  }

  // A change of rate was found: this angle, already booked at rest, belongs to the manoeuvre.
  void move_to_manoeuvre(std::size_t axis, double angle_rad) noexcept {
    at_rest_[axis] -= angle_rad;
    manoeuvre_[axis] += angle_rad;
  }
  // The same, of an angle that came together over so many samples before the change was found.
  void move_to_before(std::size_t axis, double angle_rad, double samples) noexcept {
    const double old = std::abs(before_[axis]), fresh = std::abs(angle_rad);
    at_rest_[axis] -= angle_rad;
    before_[axis] += angle_rad;
    if (old + fresh > 0.0)
      before_s_[axis] =
          (old * before_s_[axis] + fresh * std::max(kQuickSamples, samples) * period_s_) / (old + fresh);
  }
  // From here on it is remembered what the account at rest grows by.
  void mark(std::size_t axis) noexcept { marked_[axis] = at_rest_[axis]; }
  [[nodiscard]] double since_mark(std::size_t axis) const noexcept { return at_rest_[axis] - marked_[axis]; }
  // Samples that were passed over as outliers turned out to be rotation: of a manoeuvre, or of rest.
  void admit(std::size_t axis, double angle_rad) noexcept { manoeuvre_[axis] += angle_rad; }
  void admit_at_rest(std::size_t axis, double angle_rad) noexcept { at_rest_[axis] += angle_rad; }
  // Samples that what follows the motion looks back on.
  void pace(double samples) noexcept {
    const double quick = std::max(kQuickSamples, kQuickShare * samples);
    quick_s_ = quick * period_s_;
    common_ = kCommon * kQuickShare * samples / quick;
  }
  // Twice the covariance, by the measurements' noise, of what follows the motion and its payments, over the
  // variance of the former.
  [[nodiscard]] double common() const noexcept { return common_; }
  // In the tail of a motion the filter at rest is a mean over so long, s; 0: it has settled.
  void follow_tail(double mean_s) noexcept { tail_s_ = mean_s; }
  // From this rate on the filter at rest owes by its lag what it moves by. What the account holds now no
  // return of the rate pays back.
  void refer(std::size_t axis, double rest) noexcept { followed_[axis] = reference_[axis] = rest; }
  // Another lag of the filter at rest, s, at these rates of it. What it owed by the one before it still owes.
  void set_lag(double lag_s, const Axes& rest) noexcept {
    for (std::size_t a = 0; a < rest.size() && lag_s > 0.0; ++a) {
      followed_[a] = rest[a] - (rest[a] - followed_[a]) * lag_s_ / lag_s;
      reference_[a] = rest[a] - (rest[a] - reference_[a]) * lag_s_ / lag_s;
    }
    lag_s_ = lag_s;
  }

  [[nodiscard]] double owed(std::size_t axis) const noexcept {
    return at_rest_[axis] + manoeuvre_[axis] + before_[axis];
  }
  // Takes over another ledger's debt, which its filter's lag no longer returns.
  void owe(std::size_t axis, double angle_rad) noexcept {
    manoeuvre_[axis] += angle_rad;
    quick_s_ = std::max(quick_s_, kOwedSamples * period_s_);
  }
  // Of a filter that is to begin again: all is owed to nobody, until it is told so anew.
  void forget() noexcept { at_rest_ = manoeuvre_ = before_ = {}; }

 private:
  static constexpr double kNoLimit = 1e300;
  // Slower, the tail of a motion is owed for minutes; quicker, a lasting ramp is paid more than a fifth of
  // its lag.
  static constexpr double kSlowShare = 0.13;
  static constexpr double kSlowLags = 20.0;
  static constexpr double kSlowSamples = 100.0;
  static constexpr double kReturnLags = 50.0;
  static constexpr double kReturnSamples = 1000.0;
  static constexpr double kQuickShare = 0.5;
  static constexpr double kQuickSamples = 16.0;
  static constexpr double kOwedSamples = 1024.0;
  // As found in seas, swings and ramps: 0.26 to 0.30. By the impulse responses of a tracker and of what is
  // paid over half of its memory it would be 0.49; the lag that is returned takes from it.
  static constexpr double kCommon = 0.27;

  double period_s_;
  bool follows_;
  double quick_s_ = kQuickSamples * period_s_;
  double common_ = 0.0;
  double lag_s_ = 0.0;
  double tail_s_ = 0.0;
  Axes at_rest_{}, manoeuvre_{}, before_{};
  Axes before_s_{}, marked_{};
  Axes followed_{}, reference_{};  // y0, and what it follows
};

}  // namespace ifog
