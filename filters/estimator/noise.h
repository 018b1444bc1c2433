// SPDX-License-Identifier: Apache-2.0
// Noise of one axis (known R and third differences) and of all axes of a sensor.
//
// R is configured or learned at rest; only walk.h changes it, with stretches that are white in every octave.
// README.md says what third differences are used for.
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

inline constexpr double kColoured = 1.1;    // threshold of Noise::colour() for coloured noise
inline constexpr double kOtherNoise = 2.0;  // known noise is replaced if a stretch differs by this factor

class Noise {
 public:
  // known: R, (rad/s)^2.
  explicit Noise(double known = 1.0) noexcept : known_(known), slow_(known), fast_(known) {}

  // Adds a measurement, rad/s. steps: nominal samples since the last one.
  void take(double rate, double steps) noexcept {
    const double step = std::abs(rate - last_[2]);
    if (in_row_ > 0 && step > 0.0) digit_ = std::min(digit_, step);
    if (steps < 0.5 || steps > 1.5) in_row_ = 0;
    if (in_row_ >= 3) {
      const double third = rate - 3.0 * last_[2] + 3.0 * last_[1] - last_[0];
      // An outlier counts for at most five standard deviations.
      const double square = third * third * (1.0 / kThird);
      fast_ += (std::min(square, kMostSquare * fast_) - fast_) / std::min(kFast, taken_ + 4.0);
      // The usual level is not learned while the present one is significantly higher.
      if (significant_excess() == 1.0)
        slow_ += (std::min(square, kMostSquare * slow_) - slow_) / std::min(kSlow, taken_ + 1.0);
      taken_ += 1.0;
      refresh_colour();
    }
    in_row_ = std::min(in_row_ + 1, 3);
    last_ = {last_[1], last_[2], rate};
  }
  void set_known(double noise) noexcept {
    known_ = long_ = noise;
    slow_ = fast_;
    refresh_colour();
  }
  // R of long means, (rad/s)^2, as a stretch of noise has shown it.
  void set_long(double noise) noexcept { long_ = noise; }
  [[nodiscard]] double known() const noexcept { return known_; }
  // R for motion tests: a rate halfway between two steps d of the converter has the variance d^2 / 4.
  [[nodiscard]] double tested() const noexcept { return std::max(known_, 0.25 * digit() * digit()); }
  // Ratio of third differences to their usual level, if significant; else 1.
  [[nodiscard]] double significant_excess() const noexcept {
    return taken_ > kFast && fast_ > kSignificant * usual() ? excess() : 1.0;
  }
  // The same without the significance test, at least 1; for filters that treat any excess as noise.
  [[nodiscard]] double excess() const noexcept { return std::max(1.0, fast_ / usual()); }
  // Ratio of third differences to the known noise, at least 1; includes broadband motion.
  [[nodiscard]] double over_known() const noexcept { return std::max(1.0, fast_ / known_); }
  // Variance of the known noise / that of white noise with the same third differences; 1 within chance.
  [[nodiscard]] double colour() const noexcept { return colour_; }
  // Share of the noise's correlation that is lost from sample to sample if it is of first order; 1: white. R of long means
  // is (2 - r) / r of known(). Until it is known, r is from third differences: colour() of 20 / (20 - 30 p + 12 p^2 - 2 p^3),
  // p = 1 - r, solved to 3 %.
  [[nodiscard]] double decay() const noexcept {
    return long_ > 0.0 ? 2.0 / (1.0 + std::max(1.0, long_ / known_)) : 1.0 / (0.4 + 0.6 * colour_);
  }
  // Mean error variance of an average of values rounded to steps d, over all true levels: first harmonic of
  // the sawtooth, d / pi exp(-2 pi^2 R / d^2) (Widrow and Kollar, "Quantization Noise", 2008).
  [[nodiscard]] double rounding() const noexcept {
    // A learned R includes the rounding variance d^2 / 12; a smaller R is that of the sensor alone.
    const double d2 = digit() * digit(), own = of_steps(), white = known_ > 1.2 * own ? known_ - own : known_;
    const double pi_squared = std::numbers::pi * std::numbers::pi, exponent = 4.0 * pi_squared * white / d2;
    return exponent < 600.0 ? d2 / (2.0 * pi_squared) * exponential(-exponent) : 0.0;
  }
  // Rounding variance of the converter, d^2 / 12.
  [[nodiscard]] double of_steps() const noexcept { return digit() * digit() / 12.0; }

 private:
  // The cube root of a mean square with n d.o.f. is nearly normal with mean 1 - 2 / 9n and variance 2 / 9n
  // (Wilson and Hilferty, PNAS 17, 1931).
  void refresh_colour() noexcept {
    if (taken_ <= kSlow) {
      const double chance = kThirdVariance / (9.0 * std::max(taken_, 1.0));
      const double root = std::max(0.0, 1.0 - chance - kSurely * std::sqrt(chance));
      least_ = root * root * root;
    }
    colour_ = usual() < least_ * known_ ? known_ / usual() : 1.0;
  }
  // Converter's step, rad/s; 0 until the rate has changed.
  [[nodiscard]] double digit() const noexcept { return std::isfinite(digit_) ? digit_ : 0.0; }
  // R from third differences, limited because a converter between two steps shows none.
  [[nodiscard]] double usual() const noexcept { return std::max({slow_, 1e-9 * known_, of_steps()}); }
  static constexpr double kThird = 20.0;                 // 1 + 9 + 9 + 1
  static constexpr double kFast = 32.0, kSlow = 1024.0;  // samples
  // Variance of the mean square of n overlapping third differences of white noise: 2 (1 + 1.3) / n R^2.
  static constexpr double kThirdVariance = 4.6, kSurely = 3.0;
  // Four standard deviations: the mean square of 32 overlapping third differences scatters by 0.4.
  static constexpr double kSignificant = 2.6;

  double known_, slow_, fast_, long_ = 0.0, taken_ = 0.0, least_ = 0.0, colour_ = 1.0,
                               digit_ = std::numeric_limits<double>::infinity();
  std::array<double, 3> last_{};
  int in_row_ = 0;
};

// Noise of all axes: R of each and the walk of the rates, as given and learned.
class SensorNoise {
 public:
  // colour_variance: of the state model's coloured noise, (rad/s)^2. The known R includes it.
  SensorNoise(const FilterSettings& settings, const KnownNoise& known, std::size_t axes, double period_s,
              double colour_variance) noexcept;

  // Adds measurements, rad/s. since: nominal samples since each axis was measured.
  void take(const Sample& now, const Lanes& since) noexcept;
  // Learns from a measurement and updates the filter. At rest: the walk, and R if it is lower than known. In
  // a manoeuvre: R, if the apparent motion is white for a minute.
  void learn(const Axes& rate, std::uint32_t valid, bool at_rest, RestFilter& filter) noexcept;
  // After missing samples or a change of the averaging time.
  void gap() noexcept {
    walk_.gap();
    in_motion_.gap();
  }

  // One figure of each axis; 1 for lanes without axis.
  [[nodiscard]] Lanes each(double (Noise::*figure)() const noexcept) const noexcept {
    Lanes all = Lanes::Ones();
    for (std::size_t a = 0; a < axes_; ++a) all[static_cast<Eigen::Index>(a)] = (noise_[a].*figure)();
    return all;
  }
  // Mean over the sensor's axes.
  [[nodiscard]] double mean(const Lanes& of) const noexcept {
    return (of * mask_of(axes_of_sensor(axes_))).sum() / static_cast<double>(axes_);
  }
  [[nodiscard]] double mean_known() const noexcept { return mean_; }  // (rad/s)^2
  [[nodiscard]] double over_given() const noexcept { return mean_ / given_; }
  // Share of R that is white by the state model.
  [[nodiscard]] double white() const noexcept { return white_; }
  // R of each axis / mean R, and the same for the walk.
  [[nodiscard]] const Lanes& share() const noexcept { return share_; }
  [[nodiscard]] Lanes walk_share() const noexcept { return walk_share_ ? to_lanes(*walk_share_) : share_; }
  [[nodiscard]] LearnedNoise learned() const noexcept;

 private:
  void refresh_share() noexcept;

  std::size_t axes_;
  double period_s_, process_noise_, given_, white_, mean_ = 1.0;
  bool learns_walk_;
  std::optional<Axes> walk_share_;
  std::array<Noise, kMaxAxes> noise_;
  Lanes share_ = Lanes::Ones();
  Walk walk_, in_motion_;  // at rest, and in what appears to be motion
  bool at_rest_ = true;
};

}  // namespace ifog
