// SPDX-License-Identifier: Apache-2.0
// What innovations at rest have become louder by that third differences do not hear: a motion too small and
// too quick for any tracker to follow, or noise that has become coloured. Nobody can tell which. It is
// filtered out as noise is, and where it was rotation the rate is off by it, so its variance belongs to the
// rate's.
//
// Both are summed over the same samples, so noise that becomes louder, and is as white as before, changes
// nothing. Louder is what no chance explains beside what has been usual since the filter began, by how much
// the ratio of the two sums usually varies. Of that nothing is learned for the usual; what is surely quieter
// takes its place.
#pragma once

#include <algorithm>

namespace ifog {

class Vibration {
 public:
  // Of one measurement at rest: the square of its innovation and the variance of white noise by its third
  // difference, both bounded against outliers. digit: variance of what a coarse converter adds to it.
  void take(double square, double rough, double digit = 0.0) noexcept {
    square_ += square;
    rough_ += rough;
    if (++in_sum_ == kSum) judge(digit);
  }
  // A motion was found that explains it, and is followed.
  void forget() noexcept {
    lately_ratio_ = usual_;
    square_ = rough_ = variance_ = 0.0;
    in_sum_ = 0;
  }
  // Of what may be motion, (rad/s)^2; 0: nothing is louder.
  [[nodiscard]] double variance() const noexcept { return variance_; }

 private:
  // Measurements of a sum, more than those in which colour or an outlier goes through; sums that "lately" is
  // the mean of, that have to be there before one is judged, and that the usual is the mean of.
  static constexpr int kSum = 256;
  static constexpr double kLately = 8.0, kFewest = 16.0, kUsual = 512.0;
  // So many standard deviations are none of chance.
  static constexpr double kSurely = 4.0;

  // Of a converter that showed one value all along, or the rounding of the subtraction, nothing is rough.
  void judge(double digit) noexcept {
    const double rough = rough_ / kSum, ratio = square_ / rough_;
    const bool heard = rough_ > digit;
    square_ = rough_ = variance_ = 0.0;
    in_sum_ = 0;
    if (!heard) return;
    lately_ = std::min(lately_ + 1.0, kLately);
    lately_ratio_ += (ratio - lately_ratio_) / lately_;
    lately_rough_ += (rough - lately_rough_) / lately_;
    const double apart = lately_ratio_ - usual_;
    // An exponential mean knows as much as one of nearly twice the number.
    const double chance = scatter_ * usual_ * usual_ * (1.0 / (2.0 * kLately) + 1.0 / std::max(sums_, 1.0));
    const bool surely = sums_ >= kFewest && apart * apart > kSurely * kSurely * chance;
    if (surely && apart > 0.0) {
      variance_ = apart * lately_rough_;
      return;
    }
    if (surely) sums_ = lately_ = 0.0;
    learn(ratio);
  }

  void learn(double ratio) noexcept {
    sums_ = std::min(sums_ + 1.0, kUsual);
    const double off = sums_ > 1.0 ? ratio - usual_ : 0.0;
    usual_ = sums_ > 1.0 ? usual_ + off / sums_ : ratio;
    if (!(usual_ > 0.0) || sums_ <= 1.0) return;
    scattered_ = std::min(scattered_ + 1.0, kUsual);
    // The first ones are in the mean that they are held against.
    const double square = off * off * (sums_ - 1.0) / (sums_ * usual_ * usual_);
    scatter_ += (square - scatter_) / scattered_;
  }

  double square_ = 0.0, rough_ = 0.0;
  int in_sum_ = 0;
  double lately_ratio_ = 0.0, lately_rough_ = 0.0, lately_ = 0.0;
  double usual_ = 0.0, sums_ = 0.0;         // ratio of a sum's two, and of how many
  double scatter_ = 0.0, scattered_ = 0.0;  // its relative variance, likewise
  double variance_ = 0.0;
};

}  // namespace ifog
