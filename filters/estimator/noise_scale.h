// SPDX-License-Identifier: Apache-2.0
// How loud an axis is, whatever moves: from third differences, which hardly see motion, from the innovations
// at rest, and from the last digit.
//
// A third difference of white noise has variance 20 R; of a motion of f cycles a sample it passes (2 sin pi
// f)^6. So it is an estimate of white noise under way, and within some 30 samples it tells noise that has
// become louder from motion. What it does not see is colour. That is known from rest: the variance of the
// innovations there over that of third differences, learned slowly, so that neither a motion about to be
// found nor a turn of louder noise counts for colour.
#pragma once

#include <array>
#include <cstdint>

#include "filters/estimator/third_difference.h"
#include "filters/estimator/vibration.h"

namespace ifog {

class NoiseScale {
 public:
  // told: R, (rad/s)^2, believed with a few degrees of freedom until enough innovations are there.
  explicit NoiseScale(double told = 1.0) : told_(told), rest_(told), local_(told) {}

  // Before the first measurement: colour() as an earlier filter has found it.
  void recall(double colour) noexcept;

  // The next measurement, scaled to the nominal period's noise, so many samples after the one before it: more
  // than one where some are missing. Call break_off() where what lies between is not known.
  void take(double rate, double steps = 1.0) noexcept;
  void break_off() noexcept { in_a_row_ = 0; }
  // An innovation of the filter at rest, scaled likewise; lag: of that filter, in samples; foreseen: the
  // noise's variance by the tracker that foresees best, while the scale is not known. True when this was the
  // one that made it known.
  bool learn(double innovation, double lag, double foreseen) noexcept;

  // Variance of an innovation at rest as the noise is now.
  [[nodiscard]] double now() const noexcept;
  [[nodiscard]] bool known() const noexcept { return known_; }
  // Degrees of freedom that now() stands on.
  [[nodiscard]] double degrees() const noexcept {
    return known_ ? kSure : kToldDegrees + kIndependent * rough_count_;
  }
  // Third differences enough that now() is not far from the noise, whatever was told.
  [[nodiscard]] bool heard() const noexcept { return known_ || rough_count_ >= kHeard; }
  // The sensor moves, and what it is rough by is all that is its noise: known from here on.
  void take_roughness() noexcept;
  // What looks like a motion of this variance may be the noise that was told: as loud as that, much quieter
  // to be heard, foreseen no better than strong colour can be, and no rest has yet been long enough to know
  // it by.
  [[nodiscard]] bool explains(double variance, double foreseen) const noexcept {
    return known_ && !colour_known() && variance <= kLouder * told_ && kTold * variance >= told_ &&
           kLouder * rough_ <= told_ && foreseen > kForeseenColour * rough_;
  }
  // It is that.
  void take_for_colour(double variance) noexcept;
  // At rest, over the last thousand samples.
  [[nodiscard]] double rest() const noexcept { return rest_; }
  // The same with outliers that were taken in, whole: what a mean of the measurements has of them.
  [[nodiscard]] double with_tails() const noexcept { return rest_ + tails_ * rough_; }
  // Variance of the innovations over that of white noise which is as rough as they are; 1: white.
  [[nodiscard]] double colour() const noexcept { return colour_; }
  [[nodiscard]] bool white() const noexcept { return colour_ < kWhite; }
  // It stands on as much rest as it is ever a mean over; before, it may be what a motion has left.
  [[nodiscard]] bool colour_known() const noexcept { return colour_count_ >= kColourMemory; }
  // What the mean of a level that a coarse converter rounds is off by, mean square, where that mean is known
  // with this variance: by the first harmonics of the sawtooth of rounding, smoothed by the noise (Widrow and
  // Kollar, "Quantization Noise", 2008, chapter 4). It is little where the level is one of the converter's or
  // lies between two, and most in a quarter of the way. No filter sees it.
  [[nodiscard]] double rounding(double mean, double variance) const noexcept;
  // Variance of what may be a motion that is taken for noise.
  [[nodiscard]] double vibration() const noexcept { return vibration_.variance(); }
  void follow_motion() noexcept { vibration_.forget(); }
  // R for the gain. Where the innovations are louder than their roughness says, that may be colour or motion
  // the filter lags behind. To take that much colour for motion costs 1 % of RMSE, to take motion for colour
  // makes the lag longer; so the first part counts for motion.
  [[nodiscard]] double greatest_noise() const noexcept;

 private:
  // Innovations that make the scale known.
  static constexpr int kLearning = 63;
  // Different values among them: a coarse sensor may show the same one for long, and that is no noise of
  // zero.
  static constexpr int kDifferent = 32;
  // After so many, none of whose neighbours were alike, as in a queue that merges now two and now nine, the
  // noise is what was told until it can be heard.
  static constexpr int kUnheard = 4 * kLearning;
  // What was told counts for so many third differences, which overlap.
  static constexpr double kToldCount = 4.0;
  static constexpr double kIndependent = 0.43;
  static constexpr double kToldDegrees = 2.0;
  static constexpr double kSure = 1e6;
  static constexpr double kHeard = 16.0;
  // Of noise, be it a walk's own walk, second differences are at most 1.7 times as loud as third ones say.
  static constexpr double kSmooth = 2.5;
  static constexpr double kLocalMemory = 32.0;
  static constexpr double kMemory = 1024.0;
  // The mean over the local memory over that of the long one: 0.25 to 3.6 in 5e7 samples of white noise.
  static constexpr double kRougher = 4.0;
  static constexpr double kSmoother = 0.1;
  static constexpr double kRougherMemory = 128.0;
  static constexpr double kColourMemory = 8192.0;
  static constexpr double kWhite = 1.25;
  // Neighbours correlated by 0.9998; more is no noise.
  static constexpr double kMostColour = 1e4;
  // Of the ratio of innovations to roughness so much counts for motion.
  static constexpr double kMotion = 0.5;
  // Innovations this much louder than rough are motion or colour; motion where a tracker foresees them this
  // nearly to the roughness.
  static constexpr double kLouder = 2.0;
  static constexpr double kForeseen = 1.4;
  // Noise whose neighbours are correlated by 0.8 or more is foreseen by nobody to less than 2.7 times its
  // roughness (innovation variance over that of third differences; 3.0 at 0.9, 3.2 at 0.98). And a motion may
  // be as quick as that: unless its variance is about what was told, too, it is one.
  static constexpr double kForeseenColour = 2.5;
  static constexpr double kTold = 4.0;
  // A square counts for this many variances at most, so that an outlier is none.
  static constexpr double kClip = 25.0;
  // The ratio of two variances is spoiled by less.
  static constexpr double kColourClip = 9.0;
  // More, and the mean is not everywhere the steeper, the further a level is from the converter's own.
  static constexpr double kMostSecond = 0.25;
  // Of the limit above the roughness, whose own error is 4 %.
  static constexpr double kMargin = 1.05;

  void follow_roughness() noexcept;
  void settle(double foreseen) noexcept;
  void round_to(double digit) noexcept;

  double told_, rest_, local_;
  double rough_ = 0.0, rough_count_ = 0.0;  // variance by third differences, measurements in it
  double bent_ = 0.0, bent_count_ = 0.0;    // the same by second ones, until the scale is known
  double recalled_ = 1.0;                   // colour
  double colour_ = 1.0, colour_count_ = 0.0;
  double tails_ = 0.0;  // of the same squares what is beyond kColourClip
  Vibration vibration_;
  double third_ = -1.0, bound_ = 0.0;  // of the last measurement, as in rough_; below 0: none
  double mean_ = 0.0;                  // of the innovations over a lag: a slow motion's, and no noise
  double squares_ = 0.0;
  double digit_ = 1e300;         // least difference of two neighbours
  double digit_variance_ = 0.0;  // of what rounding to it adds to a measurement
  double rounding_ = 0.0;        // of the first harmonic, over where the level lies
  double second_ = 0.0;          // twice the second one's share of it
  int learned_ = 0, different_ = 0, changing_for_ = 0, in_a_row_ = 0;
  bool known_ = false;
  std::array<double, 3> last_{};
  std::array<double, 2> steps_{};  // between these
  ShortestSpan spans_;
};

}  // namespace ifog
