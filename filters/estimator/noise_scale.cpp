// SPDX-License-Identifier: Apache-2.0
#include "filters/estimator/noise_scale.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/random/circle.h"
#include "filters/random/log_exp.h"

namespace ifog {
namespace {

// What rounding takes from the mean of a level so many turns between two steps, over the first harmonic's
// amplitude, and its slope by the angle.
struct Sawtooth {
  double off = 0.0, slope = 1.0;
};

Sawtooth sawtooth(double turns, double second) noexcept {
  const OnCircle at = on_circle(turns);
  return {at.sine * (1.0 - second * at.cosine), at.cosine - second * (2.0 * at.cosine * at.cosine - 1.0)};
}

}  // namespace

// Rounding to a digit d has variance d^2 / 12: a single one of them is never far out.
double NoiseScale::now() const noexcept { return std::max({rest_, local_, digit_variance_}); }

double NoiseScale::greatest_noise() const noexcept {
  return kMargin * (known_ ? rest_ / colour_ : rest_) * std::max(1.0, colour_ - kMotion);
}

void NoiseScale::round_to(double digit) noexcept {
  digit_ = digit;
  if (digit_ < 1e150) digit_variance_ = digit_ * digit_ / 12.0;
  if (digit_ > 1e150) return;
  constexpr double kPi = std::numbers::pi;
  const double hidden = 4.0 * kPi * kPi * told_ / (digit_ * digit_);
  second_ = exponential(-1.5 * std::min(hidden, 50.0));
  rounding_ = hidden < 50.0 ? digit_ * digit_ / (2.0 * kPi * kPi) * exponential(-hidden) : 0.0;
}

// A level x has the mean x - B sin u (1 - q cos u), u its place between two steps in radians: the sawtooth's
// first two harmonics, q twice the second one's share. Newton's way from the far end solves it. Where noise
// is so small that three harmonics are needed the mean is not asked where the level lies. It may be elsewhere
// by its noise: at three places, that have the moments of a normal distribution, each as likely as many
// levels have that mean.
double NoiseScale::rounding(double mean, double variance) const noexcept {
  if (!(rounding_ > 0.0)) return 0.0;
  if (second_ >= kMostSecond) return rounding_ * (1.0 + 0.25 * second_ * second_);
  constexpr double kTurn = 2.0 * std::numbers::pi;
  const double steep = kTurn * std::sqrt(2.0 * rounding_) / digit_;
  const double aside = std::sqrt(3.0 * std::max(0.0, variance));
  double squares = 0.0, levels = 0.0;
  for (const int to : {-1, 0, 1}) {
    double turns = (mean + to * aside - last_[2]) / digit_;
    turns -= std::nearbyint(turns);
    double level = turns > 0.0 ? 0.5 : -0.5;
    Sawtooth at = sawtooth(level, second_);
    for (int i = 0; i < 5; ++i) {
      level -= (level - steep / kTurn * at.off - turns) / (1.0 - steep * at.slope);
      at = sawtooth(level, second_);
    }
    const double likely = (to == 0 ? 4.0 : 1.0) / (1.0 - steep * at.slope);
    squares += likely * at.off * at.off;
    levels += likely;
  }
  return 2.0 * rounding_ * squares / levels;
}

void NoiseScale::take(double rate, double steps) noexcept {
  const double step = std::abs(rate - last_[2]);
  changing_for_ = step > 0.0 ? std::min(changing_for_ + 1, kDifferent) : 0;
  if (step > 0.0) {
    different_ = std::min(different_ + 1, kDifferent);
    if (in_a_row_ > 0 && step < digit_) round_to(step);
  }
  const double span = steps_[0] + steps_[1] + steps;
  const bool asked = in_a_row_ >= 3 && spans_.take(span);
  if (in_a_row_ >= 2 && !known_ && steps == steps_[1]) {
    const double second = rate - 2.0 * last_[2] + last_[1];
    bent_count_ += 1.0;
    bent_ += (second * second / 6.0 - bent_) / bent_count_;
  }
  third_ = -1.0;
  if (asked) {
    const double square =
        third_difference_square({last_[0], last_[1], last_[2], rate}, {steps_[0], steps_[1], steps});
    local_ += (std::min(square, kClip * now()) - local_) / std::min(kLocalMemory, kToldCount + rough_count_);
    rough_count_ = std::min(rough_count_ + 1.0, kMemory);
    // Beside the scale, so that a coarse sensor's runs of equal values do not end in a variance of zero that
    // nothing could raise again.
    bound_ = kClip * std::max({rough_, 0.5 * rest_, digit_variance_});
    third_ = std::min(square, bound_);
    rough_ += (third_ - rough_) / rough_count_;
    follow_roughness();
    if (known_) rest_ = colour_ * std::max(rough_, 1e-9 * told_);
  }
  in_a_row_ = std::min(in_a_row_ + 1, 3);
  last_ = {last_[1], last_[2], rate};
  steps_ = {steps_[1], steps};
}

// Noise that has become louder by more than any draw of it is believed sooner. Of a blow only its edges are
// rough, and what swings after it is no noise because of them: where the last measurements are so much
// smoother that chance does not explain it, what came before them is forgotten. Neither a converter that
// shows one value for a while nor a sensor that hangs has become quieter.
void NoiseScale::follow_roughness() noexcept {
  if (known_ && local_ > kRougher * rough_) rough_count_ = std::min(rough_count_, kRougherMemory);
  if (local_ >= kSmoother * rough_ || local_ <= digit_variance_ || changing_for_ < kDifferent) return;
  rough_ = local_;
  rough_count_ = std::min(rough_count_, kLocalMemory);
}

void NoiseScale::recall(double colour) noexcept {
  if (colour > 1.0 && colour < kMostColour) recalled_ = colour;
}

// What was told counts only where the innovations are much louder than they are rough and no tracker follows
// them: then it is colour, and how slow it is nothing else says yet. What is smoother than any noise is
// motion, though it be too quick for the trackers that are asked.
void NoiseScale::settle(double foreseen) noexcept {
  if (rough_count_ < kDifferent) rough_ = told_;
  const double rough = std::max(rough_, 1e-9 * told_);
  const double found = squares_ / learned_;
  const double usual = recalled_ * rough;
  const bool motion = foreseen <= kForeseen * rough || bent_ > kSmooth * rough;
  rest_ = found <= kLouder * usual || motion ? usual : std::max(told_, usual);
  rough_ = rough;
  colour_ = rest_ / rough;
  colour_count_ = recalled_ > 1.0 ? kColourMemory : kMemory;
  local_ = std::min(local_, rest_);
  known_ = true;
}

void NoiseScale::take_roughness() noexcept {
  if (!known_) settle(0.0);
}

void NoiseScale::take_for_colour(double variance) noexcept {
  const double rough = std::max(rough_, 1e-9 * told_);
  colour_ = std::max(1.0, variance / rough);
  colour_count_ = kMemory;
  rest_ = colour_ * rough;
}

bool NoiseScale::learn(double innovation, double lag, double foreseen) noexcept {
  if (!known_) {
    squares_ += innovation * innovation;
    if (++learned_ < kLearning || different_ < kDifferent) return false;
    if (rough_count_ < kDifferent && learned_ < kUnheard) return false;
    settle(foreseen);
    return true;
  }
  const double apart = innovation - mean_;
  mean_ += apart / std::max(lag, 2.0 * kLocalMemory);
  const double square = std::min(apart * apart, kColourClip * rest_);
  const double rough = std::max(rough_, 1e-9 * told_);
  colour_count_ = std::min(colour_count_ + 1.0, kColourMemory);
  colour_ += (square / rough - colour_) / colour_count_;
  // Noise that has just become louder has no tails.
  const double beyond = std::max(0.0, apart * apart - kColourClip * std::max(rest_, local_));
  tails_ += (beyond / rough - tails_) / colour_count_;
  colour_ = std::max(colour_, 0.5);
  // Bounded alike, so that of noise that has just become louder both are.
  if (third_ >= 0.0) vibration_.take(std::min(apart * apart, bound_), third_, digit_variance_);
  return false;
}

}  // namespace ifog
