// SPDX-License-Identifier: Apache-2.0
// The noise of one axis, R as it is known and what third differences say beside it, and of all axes of a sensor.
//
// R is what the filter was given or has learned at rest; only walk.h changes it, by stretches that are white
// over every octave. Third differences do not see a parabola: for white noise they give R whatever moves
// smoothly, for broadband motion an upper bound of R, for coloured noise less than R. So they say three
// things and no more: how large a measurement's variance may be now, how coloured the known noise is, and how
// coarse the converter is.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <limits>
#include <numbers>

#include "filters/estimator/estimator.h"
#include "filters/estimator/rest_filter.h"
#include "filters/estimator/sample.h"
#include "filters/estimator/walk.h"
#include "filters/random/log_exp.h"

namespace ifog {

inline constexpr double kColoured = 1.1;    // noise is coloured if Noise::colour() is above this
inline constexpr double kOtherNoise = 2.0;  // known noise is replaced where a stretch differs by this factor

class Noise {
 public:
  // known: R, (rad/s)^2.
  explicit Noise(double known = 1.0) noexcept : known_(known), slow_(known), fast_(known) {}

  // The next measurement, rad/s, that follows the last one after so many nominal samples.
  void take(double rate, double steps) noexcept {
    const double step = std::abs(rate - last_[2]);
    if (in_row_ > 0 && step > 0.0) digit_ = std::min(digit_, step);
    if (steps < 0.5 || steps > 1.5) in_row_ = 0;
    if (in_row_ >= 3) {
      const double third = rate - 3.0 * last_[2] + 3.0 * last_[1] - last_[0];
      // An outlier counts for at most five standard deviations.
      const double square = third * third * (1.0 / kThird);
      fast_ += (std::min(square, kMostSquare * fast_) - fast_) / std::min(kFast, taken_ + 4.0);
      // The usual level is not learned while it is surely exceeded.
      if (louder() == 1.0)
        slow_ += (std::min(square, kMostSquare * slow_) - slow_) / std::min(kSlow, taken_ + 1.0);
      taken_ += 1.0;
      refresh_colour();
    }
    in_row_ = std::min(in_row_ + 1, 3);
    last_ = {last_[1], last_[2], rate};
  }
  void set_known(double noise) noexcept {
    known_ = noise;
    slow_ = fast_;
    refresh_colour();
  }
  [[nodiscard]] double known() const noexcept { return known_; }
  // R for tests of motion: a rate halfway between two steps of the converter has d^2 / 4 about its mean.
  [[nodiscard]] double tested() const noexcept { return std::max(known_, 0.25 * digit() * digit()); }
  // By which third differences are now above their usual level: 1 unless by more than chance.
  [[nodiscard]] double louder() const noexcept {
    return taken_ > kFast && fast_ > kSurelyLouder * usual() ? heard() : 1.0;
  }
  // The same without that doubt, 1 at least: for who takes all that is louder for noise.
  [[nodiscard]] double heard() const noexcept { return std::max(1.0, fast_ / usual()); }
  // By which third differences are now above the known noise, 1 at least: broadband motion is in them.
  [[nodiscard]] double shaken() const noexcept { return std::max(1.0, fast_ / known_); }
  // Variance of the known noise over that of equally rough white noise; 1 within chance.
  [[nodiscard]] double colour() const noexcept { return colour_; }
  // Variance of a mean of coarse steps d, averaged over the true level: that of the sawtooth's first harmonic,
  // d / pi exp(-2 pi^2 R / d^2) (Widrow and Kollar, "Quantization Noise", 2008).
  [[nodiscard]] double rounding() const noexcept {
    // R that was learned includes the steps' own d^2 / 12; one that is less than that is of the sensor alone.
    const double d2 = digit() * digit(), own = of_steps(), white = known_ > 1.2 * own ? known_ - own : known_;
    const double pi_squared = std::numbers::pi * std::numbers::pi, exponent = 4.0 * pi_squared * white / d2;
    return exponent < 600.0 ? d2 / (2.0 * pi_squared) * exponential(-exponent) : 0.0;
  }
  // Variance of one of the converter's steps.
  [[nodiscard]] double of_steps() const noexcept { return digit() * digit() / 12.0; }

 private:
  // The cube root of a mean square of n degrees of freedom is nearly normal about 1 - 2 / 9n with variance 2 / 9n
  // (Wilson and Hilferty, PNAS 17, 1931).
  void refresh_colour() noexcept {
    if (taken_ <= kSlow) {
      const double chance = kThirdVariance / (9.0 * std::max(taken_, 1.0));
      const double root = std::max(0.0, 1.0 - chance - kSurely * std::sqrt(chance));
      least_ = root * root * root;
    }
    colour_ = usual() < least_ * known_ ? known_ / usual() : 1.0;
  }
  // The converter's step, rad/s; 0 until the rate has changed.
  [[nodiscard]] double digit() const noexcept { return std::isfinite(digit_) ? digit_ : 0.0; }
  // R by third differences. A converter at rest between two changes of its last digit shows none.
  [[nodiscard]] double usual() const noexcept { return std::max({slow_, 1e-9 * known_, of_steps()}); }
  static constexpr double kThird = 20.0;                 // 1 + 9 + 9 + 1
  static constexpr double kFast = 32.0, kSlow = 1024.0;  // samples
  // n overlapping third differences of white noise have a mean square of variance 2 (1 + 1.3) / n R^2.
  static constexpr double kThirdVariance = 4.6, kSurely = 3.0;
  // The mean square of 32 overlapping third differences scatters by 0.4: four standard deviations.
  static constexpr double kSurelyLouder = 2.6;

  double known_, slow_, fast_, taken_ = 0.0, least_ = 0.0, colour_ = 1.0,
                               digit_ = std::numeric_limits<double>::infinity();
  std::array<double, 3> last_{};
  int in_row_ = 0;
};

// The noise of all axes of a sensor: R of each and how quickly the rates walk, as given and as learned since.
class SensorNoise {
 public:
  SensorNoise(const FilterSettings& settings, const KnownNoise& known, std::size_t axes,
              double period_s) noexcept;

  // The next measurements, rad/s; since: nominal samples since each axis was measured.
  void take(const Sample& now, const Lanes& since) noexcept;
  // A measurement at rest, or in what is taken for a motion. The filter is told what that shows: at rest the walk,
  // and R where it is less than is known; in a manoeuvre R, where what looks like one is white for a minute.
  void learn(const Axes& rate, std::uint32_t valid, bool at_rest, RestFilter& filter) noexcept;
  // Behind a gap, or where the sensor averages otherwise, a stretch begins anew.
  void break_off() noexcept { walk_.break_off(); }

  // One figure of each axis; 1 where the sensor has no axis.
  [[nodiscard]] Lanes each(double (Noise::*figure)() const noexcept) const noexcept {
    Lanes all = Lanes::Ones();
    for (std::size_t a = 0; a < axes_; ++a) all[static_cast<Eigen::Index>(a)] = (noise_[a].*figure)();
    return all;
  }
  // Over the axes of the sensor.
  [[nodiscard]] double mean(const Lanes& of) const noexcept {
    return (of * mask_of(axes_of_sensor(axes_))).sum() / static_cast<double>(axes_);
  }
  [[nodiscard]] double mean_known() const noexcept { return mean_; }  // (rad/s)^2
  // R of each axis over its mean, and the same of the walk.
  [[nodiscard]] const Lanes& share() const noexcept { return share_; }
  [[nodiscard]] Lanes walk_share() const noexcept { return walk_share_ ? to_lanes(*walk_share_) : share_; }
  [[nodiscard]] LearnedNoise learned() const noexcept;

 private:
  void refresh_share() noexcept;

  std::size_t axes_;
  double period_s_, process_noise_, mean_ = 1.0;
  bool learns_walk_;
  std::optional<Axes> walk_share_;
  std::array<Noise, kMaxAxes> noise_;
  Lanes share_ = Lanes::Ones();
  Walk walk_;
};

}  // namespace ifog
