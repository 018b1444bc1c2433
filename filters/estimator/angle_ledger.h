// Keeps the angle: what the denoised rate has fallen short of the measured one, integrated, is paid back.
//
// A filter of fixed gain K loses nothing: the sum of (measured - denoised) is tau (y - y0), tau = T (1-K)/K,
// and returns to zero with the rate. A gain that follows the innovations is not the same going into a turn as
// coming out of it, and keeps a part for good. So the shortfall is booked:
//   owed   = sum (measured - denoised) dt
//   lag    = tau (y - y0), what a filter with the average gain would owe at this rate and get back by itself
//   excess = owed - lag
// and the excess goes into the output at a slow, fixed pace. While the gain is constant the excess is zero
// and so is the payment: at rest the cost is only what the fluctuation of the gain makes. Debt of a manoeuvre
// is booked apart and paid back quickly.
#pragma once

#include <algorithm>
#include <array>

#include "filters/settings/axes.h"

namespace ifog {

class AngleLedger {
 public:
  explicit AngleLedger(double period_s) : period_s_(period_s) {}

  // Rate to be added to the output of this sample. lag_s: tau of the filter at rest.
  [[nodiscard]] double payment(std::size_t axis, double lag_s) const noexcept {
    const double slow_s = kSlowLags * lag_s + kSlowSamples * period_s_;
    return excess_[axis] / slow_s + manoeuvre_[axis] / (kQuickSamples * period_s_);
  }

  // Books one sample: measured and published rate, payment included, over dt.
  void book(std::size_t axis, double measured, double published, double dt_s, bool manoeuvre) noexcept {
    const double short_by = (measured - published) * dt_s;
    owed_[axis] += short_by;
    const double paid = manoeuvre_[axis] * std::min(dt_s / (kQuickSamples * period_s_), 1.0);
    if (manoeuvre) {
      manoeuvre_[axis] += short_by;
    } else {
      manoeuvre_[axis] -= paid;
    }
  }

  // After booking, at rest: what the filter at rest owes beyond its lag. rest: its rate without payments.
  //
  // The rate at which nothing is owed follows the output: quickly after a manoeuvre, whose last part may
  // still be under way, and over a hundred lags at rest, which costs 0.25 % of RMSE (a second pole at r =
  // 1/100 of the first costs r/4). While a filter starts up its gain is not yet one that could owe anything:
  // nothing is booked for four lags.
  void settle(std::size_t axis, double rest, double lag_s) noexcept {
    const double lag_samples = lag_s / period_s_;
    age_[axis] += 1.0;
    if (starting_[axis]) {
      begin(axis, rest, age_[axis]);
      if (age_[axis] < kStartLags * lag_samples) return;
      starting_[axis] = false;
      age_[axis] = kOld;
    }
    const double samples =
        std::min(kFirstSamples + kAgeShare * age_[axis], kReferenceLags * lag_samples + kQuickSamples);
    const double moved = (rest - reference_[axis]) / samples;
    reference_[axis] += moved;
    manoeuvre_[axis] += lag_s * moved;
    excess_[axis] = owed_[axis] - manoeuvre_[axis] - lag_s * (rest - reference_[axis]);
  }

  // From rest into a manoeuvre: everything owed is now to be paid quickly.
  void begin_manoeuvre() noexcept {
    manoeuvre_ = owed_;
    excess_ = {};
  }
  // Back to rest at this rate, which from now on is the one without lag.
  void end_manoeuvre(std::size_t axis, double rest) noexcept {
    reference_[axis] = rest;
    manoeuvre_[axis] = owed_[axis];
    excess_[axis] = age_[axis] = 0.0;
    starting_[axis] = false;
  }
  // The first rate of an axis, `age` samples ago.
  void begin(std::size_t axis, double rest, double age = 0.0) noexcept {
    reference_[axis] = rest;
    owed_[axis] = manoeuvre_[axis] = excess_[axis] = 0.0;
    age_[axis] = age;
    starting_[axis] = true;
  }
  // A sample that was held back as an outlier turned out to be rotation.
  void admit(std::size_t axis, double angle_rad) noexcept { owed_[axis] += angle_rad; }

  [[nodiscard]] double owed(std::size_t axis) const noexcept { return owed_[axis]; }
  // Takes over another ledger's debt; end_manoeuvre() at the first rate says where the lag is counted from.
  void owe(std::size_t axis, double angle_rad) noexcept { owed_[axis] = angle_rad; }

 private:
  static constexpr double kSlowLags = 20.0;
  static constexpr double kSlowSamples = 100.0;
  static constexpr double kQuickSamples = 64.0;
  static constexpr double kFirstSamples = 16.0;
  static constexpr double kAgeShare = 0.25;
  static constexpr double kReferenceLags = 100.0;
  static constexpr double kStartLags = 4.0;
  static constexpr double kOld = 1e15;

  double period_s_;
  Axes owed_{}, manoeuvre_{}, excess_{}, reference_{}, age_{};
  std::array<bool, kMaxAxes> starting_{};
};

}  // namespace ifog
