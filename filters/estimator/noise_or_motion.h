// Tells noise that has a colour from motion, by whether averaging pays.
//
// A sensor whose own filter is slow beside its sample rate has noise that a tracker predicts better than the
// filter at rest does, so a test of innovations alone would follow the noise for ever. What tells them apart
// is the Allan variance: it falls with the averaging time in noise, whatever its colour, once the time is
// longer than the correlation, and rises in motion, by 2 an octave in a random walk and by 4 in a ramp. In a
// swing with a period of less than 140 samples it falls, too; there a tracker leaves little of the variance,
// and of noise correlated over 20 samples a quarter and more.
//
// Judged in windows of 4096 samples. What two in a row call noise is noise, with the smaller of their
// variances: a blow passes. It counts until a window is quieter: noise does not go away, a structure's
// ringing does.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "filters/settings/axes.h"

namespace ifog {

class NoiseOrMotion {
 public:
  static constexpr int kWindow = 4096;  // samples

  // One measurement of an axis, and its innovation from whatever follows the rate now.
  void take(std::size_t axis, double rate, double innovation) noexcept {
    Window& w = windows_[axis];
    if (w.count == 0) w.origin = rate;
    const double x = rate - w.origin;
    w.square += x * x;
    w.left += innovation * innovation;
    w.sum += x;
    if (++w.count % kShort != 0) return;
    end_block(w);
    if (w.count < kWindow) return;
    judge(findings_[axis], w);
    w = {};
  }

  // The last two windows were noise.
  [[nodiscard]] bool noise(std::size_t axis) const noexcept { return findings_[axis].noise >= 2; }
  // Of what was last known for noise, zero when nothing is: its variance, (rad/s)^2, and the variance of a
  // sum of 64 samples over 64 times that.
  [[nodiscard]] double variance(std::size_t axis) const noexcept { return findings_[axis].known_variance; }
  [[nodiscard]] double widening(std::size_t axis) const noexcept { return findings_[axis].known_widening; }

 private:
  static constexpr int kShort = 32, kLong = 64;
  // Allan variance at 64 samples over that at 32: 0.5 in white noise, 0.7 with correlation 0.9 between
  // neighbours, 0.9 with 0.95, known to 0.2.
  static constexpr double kFalls = 1.25;
  // Share of the variance that a tracker leaves at least of noise.
  static constexpr double kLeft = 0.125;
  // Noise keeps its variance from one window to the next, and from one quarter of a window to another, to
  // these factors: a blow and what rings after it do not.
  static constexpr double kSteady = 1.5;
  static constexpr double kSteadyQuarters = 3.0;

  struct Window {
    int count = 0;
    double origin = 0.0;  // first rate; sums are of what is above it
    double square = 0.0, left = 0.0;
    double sum = 0.0, last_short = 0.0, last_long = 0.0;  // of blocks
    double long_squares = 0.0;                            // of sums of 64 samples
    double short_steps = 0.0, long_steps = 0.0;  // squares of differences between neighbouring blocks
    // Squares about the means of the blocks: up to now, up to the quarter begun, and in the quietest and the
    // loudest quarter.
    double begun = 0.0, quietest = 1e300, loudest = 0.0;
    [[nodiscard]] double within() const noexcept { return square - long_squares / kLong; }
  };
  struct Finding {
    int noise = 0;                          // windows in a row
    double variance = 0.0, widening = 0.0;  // of the last window
    double known_variance = 0.0, known_widening = 0.0;
  };

  static void end_block(Window& w) noexcept {
    if (w.count > kShort) w.short_steps += (w.sum - w.last_short) * (w.sum - w.last_short);
    if (w.count % kLong == 0) {
      const double both = w.sum + w.last_short;
      w.long_squares += both * both;
      if (w.count > kLong) w.long_steps += (both - w.last_long) * (both - w.last_long);
      w.last_long = both;
    }
    w.last_short = w.sum;
    w.sum = 0.0;
    if (w.count % (kWindow / 4) != 0) return;
    const double quarter = w.within() - w.begun;
    w.begun = w.within();
    w.quietest = std::min(w.quietest, quarter);
    w.loudest = std::max(w.loudest, quarter);
  }

  static void judge(Finding& finding, const Window& w) noexcept {
    constexpr int kShortPairs = kWindow / kShort - 1, kLongPairs = kWindow / kLong - 1;
    const double allan_short = w.short_steps / (2.0 * kShort * kShort * kShortPairs);
    const double allan_long = w.long_steps / (2.0 * kLong * kLong * kLongPairs);
    // About the mean of each block, and of the blocks about each other, so that a drift does not count.
    const double variance = w.within() / kWindow + allan_long;
    const bool noise = variance > 0.0 && allan_long < kFalls * allan_short &&
                       w.left > kLeft * kWindow * variance && w.loudest < kSteadyQuarters * w.quietest;
    const double widening = variance > 0.0 ? kLong * allan_long / variance : 0.0;
    const double last = finding.variance;
    const bool steady = variance < kSteady * last && last < kSteady * variance;
    finding.noise = !noise ? 0 : steady ? finding.noise + 1 : 1;
    if (finding.noise >= 2) {
      finding.known_variance = std::min(variance, last);
      finding.known_widening = std::min(widening, finding.widening);
    } else if (kSteady * variance < finding.known_variance) {
      finding.known_variance = finding.known_widening = 0.0;
    }
    finding.variance = variance;
    finding.widening = widening;
  }

  std::array<Window, kMaxAxes> windows_{};
  std::array<Finding, kMaxAxes> findings_{};
};

}  // namespace ifog
