// Tells a change of rate from noise and from an outlier, by the innovations of the filter at rest.
//
// Innovations are divided by their own long-run scale (not by the adaptation rule's covariance, whose window
// is short and would make a 6 sigma test fire at 4), clipped, and summed over the last m for a ladder of m:
// the generalised likelihood ratio for a change of mean that began m samples ago (Willsky and Jones, IEEE
// Trans. AC 21(1), 1976). The clip makes it ask for a sustained change: one sample of any size cannot reach
// the threshold, two of 5 sigma can.
//
// On white noise each sum has variance m. Measured noise has lines and a colour: its sums over some m are
// wider, and a test that took it for white would see manoeuvres in it. So the variance of each sum is learned
// at rest, and where it is certainly above that of white noise the threshold rises with it.
#pragma once

#include <array>
#include <cstdint>
#include <span>

#include "filters/settings/axes.h"

namespace ifog {

class InnovationMonitor {
 public:
  // 6.5 sigma after normalisation: on white noise about 4e-10 per axis, window and sample, see
  // tests/bench/quality.
  static constexpr double kThreshold = 6.5;
  static constexpr double kClip = 5.0;
  // Where more than one sample in a thousand is beyond that, two in a row are no evidence: with this clip it
  // takes three. Nor is one an outlier, but the sensor's own, and carries angle: only what is much further
  // out is held back.
  static constexpr double kTailClip = 4.3;
  static constexpr double kTailOutlier = 20.0;
  static constexpr double kTails = 1e-3;
  // Innovations before the scale is trusted.
  static constexpr int kLearning = 64;

  struct Verdict {
    int changed_since =
        0;  // > 0: the mean changed and this many samples, the current one included, belong after it
    bool suspect = false;  // an outlier, not confirmed by the sample before
    bool calm = true;      // every sum as it is at rest, within kCalm sigma
  };
  static constexpr double kCalm = 4.0;

  // One innovation per axis; axes that are not valid hold zero. Does not learn the scale; learns the colour
  // when at_rest.
  Verdict test(std::span<const double> innovations, std::uint32_t valid_axes, bool at_rest) noexcept;

  // Learns the scale of an axis from an innovation whose variance is `factor` times that of the filter at
  // rest. Returns true when this was the sample that armed the monitor and the sensor had moved meanwhile:
  // innovations up to here are then no evidence of noise.
  bool learn(std::size_t axis, double innovation, double factor) noexcept;
  // A measurement of the axis at rest. Third differences (variance 20 R) hardly see motion, so they bound the
  // scale: neither a sensor that starts up on a moving vehicle nor a swing that grows out of the noise is
  // taken for noise.
  void learn_still(std::size_t axis, double rate) noexcept;

  // What has long been seen to be noise may be this loud, (rad/s)^2, and its sums this much wider than white
  // noise's, whatever third differences say.
  void allow(std::size_t axis, double variance, double widening) noexcept;
  // Takes that for the noise at once, after a manoeuvre that was none.
  void adopt(std::size_t axis, double variance, double widening) noexcept;

  // Forgets the sums, keeps the scale: the change was dealt with.
  void rearm() noexcept { length_ = 0; }

  [[nodiscard]] bool armed() const noexcept { return armed_; }
  // Variance of an innovation at rest, (rad/s)^2.
  [[nodiscard]] double variance(std::size_t axis) const noexcept { return variance_[axis]; }

 private:
  static constexpr std::array kLadder{2, 3, 4, 6, 8, 12, 16, 24, 32, 48, 64};
  static constexpr std::size_t kRing = 128;  // a power of two above the longest window
  static constexpr double kMemory = 1000.0;  // samples; the scale is then good to 2 %
  static constexpr double kTailMemory = 8192.0;
  // Every eighth sample is enough for the colour: 8192 samples are then remembered, and the variance of the
  // longest sum is known to 15 %. White noise counts for the first eight.
  static constexpr int kColourEvery = 8;
  static constexpr double kColourPrior = 8.0;
  static constexpr double kColourMemory = 1024.0;
  // A slow motion the filter lags behind widens the sums like a colour; it must not silence the test.
  static constexpr double kMostColour = 4.0;

  void learn_colour(std::size_t axis) noexcept;
  // Armed by other axes, this one had no measurements yet: a scale of nothing clips everything, and would
  // stay so.
  [[nodiscard]] bool still_learns(std::size_t axis) const noexcept {
    return armed_ && learned_[axis] < kLearning;
  }

  std::array<std::array<double, kRing>, kMaxAxes> sums_{};  // of clipped innovations, up to each sample
  Axes variance_{};
  Axes learned_{};
  Axes allowed_{};  // variance that was seen to be noise
  struct Colour {
    std::array<double, kLadder.size()> variance;  // of each sum over that of white noise
    std::array<double, kLadder.size()> widening;  // the part of it that is certain, 1 to `most`
    double most = kMostColour;
    double count = kColourPrior;
    Colour() noexcept {
      variance.fill(1.0);
      widening.fill(1.0);
    }
  };
  std::array<Colour, kMaxAxes> colour_{};
  double tails_ = 0.0;  // share of samples at rest beyond the clip
  int until_colour_ = kColourEvery;
  struct Still {
    std::array<double, 3> last{};
    double variance = 0.0;  // of a measurement, by its third differences
    double count = 0.0;     // measurements, up to kMemory
  };
  std::array<Still, kMaxAxes> still_{};
  std::size_t at_ = 0;
  int length_ = 0;
  bool armed_ = false;
  // A scale learned from k innovations is off by 1/sqrt(2k), and a test at this many sigma would feel it.
  double threshold_ = kThreshold;
};

}  // namespace ifog
