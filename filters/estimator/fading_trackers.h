// What follows the rate while it changes: trackers of rate, slope and curvature that forget at different
// speeds, and their average under the likelihood each has lately earned.
//
// A tracker is the fading-memory polynomial filter of second degree (Morrison, "Introduction to Sequential
// Smoothing and Prediction", 1969; Brookner, "Tracking and Kalman Filtering Made Easy", 1998):
// three equal poles at theta, gains 1 - theta^3, 3/2 (1 - theta)^2 (1 + theta), (1 - theta)^3. Of rate to
// output, 1 - H is the cube of a first difference: no lag on a constant slope or curvature, and a gain that
// departs from one only with the fourth power of frequency. That, not noise, is why the degree is two: the
// coning integral sees the square of the gain.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "filters/settings/axes.h"

namespace ifog {

class FadingTrackers {
 public:
  FadingTrackers();

  // Starts afresh from the last measurements, oldest first.
  void begin(std::span<const Axes> last) noexcept;
  // Rate one sample ahead of each tracker; `steps` in nominal samples, one unless samples were missed.
  void predict(double steps) noexcept;
  // Whether every tracker finds this measurement improbable, by what has lately surprised the best of them.
  // noise: measurement variance by axis.
  [[nodiscard]] bool improbable(const Axes& rate, const Axes& noise, std::uint32_t valid_axes) noexcept;
  // Starts afresh from the last measurements after one that was improbable and turned out to be motion: a
  // blow goes on as it began, and its next sample is no outlier for being as far off.
  void begin_again(std::span<const Axes> last) noexcept;
  // Takes the measurement in. level_*: prediction of the filter at rest, innovation variance over R; it
  // competes with the trackers for the weight.
  void update(const Axes& rate, const Axes& noise, std::uint32_t valid_axes, const Axes& level_innovation,
              double level_factor) noexcept;

  // Weight of the filter at rest; the trackers share the remainder.
  [[nodiscard]] double level_weight() const noexcept { return weight_[kTrackers]; }
  // Weighted mean of the trackers and of `level`.
  [[nodiscard]] double rate(std::size_t axis, double level) const noexcept;
  // Variance of that mean over R if the weights are right, spread between the members included.
  [[nodiscard]] double variance(std::size_t axis, double level, double level_variance,
                                double noise) const noexcept;
  // Gain of the mixture.
  [[nodiscard]] double gain(double level_gain) const noexcept;
  // Innovation of the likeliest tracker and its variance over R.
  [[nodiscard]] double best_innovation(std::size_t axis) const noexcept { return innovation_[best()][axis]; }
  [[nodiscard]] double best_factor() const noexcept { return factor(best()); }

 private:
  static constexpr std::size_t kTrackers = 4;
  static constexpr std::array<double, kTrackers> kTheta{0.97, 0.9, 0.7, 0.3};

  struct Gains {
    double rate = 0.0, slope = 0.0, curvature = 0.0;
    double innovation_factor = 1.0;  // settled innovation variance over R
    double output_factor = 1.0;      // settled output variance over R
  };

  [[nodiscard]] std::size_t best() const noexcept;
  [[nodiscard]] double factor(std::size_t tracker) const noexcept;
  [[nodiscard]] Gains growing(std::size_t tracker) const noexcept;
  void correct(const Axes& rate, std::uint32_t valid_axes) noexcept;

  std::array<Gains, kTrackers> settled_{};
  // Slope per sample, half the curvature per sample squared.
  std::array<Axes, kTrackers> rate_{}, slope_{}, curvature_{}, innovation_{};
  std::array<double, kTrackers + 1> log_weight_{}, weight_{};
  // Normalised square of the innovation of the best predictor: running mean, and of the last measurement.
  Axes surprise_{}, last_surprise_{};
  int age_ = 0;  // measurements taken in since begin()
  // Of the last prediction, nominal samples. The gains are those of one step, whatever its length: in units
  // of nominal samples those of slope and curvature fall with it. Left as they are, steps of two and more
  // would put the poles outside the unit circle.
  double steps_ = 1.0;
};

}  // namespace ifog
