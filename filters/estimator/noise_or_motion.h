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
// variances: a blow passes.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

#include "filters/estimator/estimator.h"

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
  // Then: its variance, (rad/s)^2, and the variance of a sum of 64 samples over 64 times that.
  [[nodiscard]] double variance(std::size_t axis) const noexcept {
    return std::min(findings_[axis].variance[0], findings_[axis].variance[1]);
  }
  [[nodiscard]] double widening(std::size_t axis) const noexcept {
    return std::min(findings_[axis].widening[0], findings_[axis].widening[1]);
  }

 private:
  static constexpr int kShort = 32, kLong = 64;
  // Allan variance at 64 samples over that at 32: 0.5 in white noise, 0.7 with correlation 0.9 between
  // neighbours, 0.9 with 0.95, known to 0.2.
  static constexpr double kFalls = 1.25;
  // Share of the variance that a tracker leaves at least of noise.
  static constexpr double kLeft = 0.125;
  // Noise keeps its variance from one window to the next, to this factor.
  static constexpr double kSteady = 1.5;

  struct Window {
    int count = 0;
    double origin = 0.0;  // first rate; sums are of what is above it
    double square = 0.0, left = 0.0;
    double sum = 0.0, last_short = 0.0, last_long = 0.0;  // of blocks
    double long_squares = 0.0;                            // of sums of 64 samples
    double short_steps = 0.0, long_steps = 0.0;  // squares of differences between neighbouring blocks
  };
  struct Finding {
    int noise = 0;  // windows in a row
    std::array<double, 2> variance{}, widening{};
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
  }

  static void judge(Finding& finding, const Window& w) noexcept {
    constexpr int kShortPairs = kWindow / kShort - 1, kLongPairs = kWindow / kLong - 1;
    const double allan_short = w.short_steps / (2.0 * kShort * kShort * kShortPairs);
    const double allan_long = w.long_steps / (2.0 * kLong * kLong * kLongPairs);
    // About the mean of each block, and of the blocks about each other, so that a drift does not count.
    const double within = (w.square - w.long_squares / kLong) / kWindow;
    const double variance = within + allan_long;
    const bool noise =
        variance > 0.0 && allan_long < kFalls * allan_short && w.left > kLeft * kWindow * variance;
    const double last = finding.variance[0];
    const bool steady = variance < kSteady * last && last < kSteady * variance;
    finding.noise = !noise ? 0 : steady ? finding.noise + 1 : 1;
    finding.variance = {variance, finding.variance[0]};
    finding.widening = {variance > 0.0 ? kLong * allan_long / variance : 0.0, finding.widening[0]};
  }

  std::array<Window, kMaxAxes> windows_{};
  std::array<Finding, kMaxAxes> findings_{};
};

}  // namespace ifog
