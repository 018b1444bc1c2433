// SPDX-License-Identifier: Apache-2.0
// What a stream shows of a sensor's noise: the variance R of the white noise of each axis, and how quickly the
// rate walks.
//
// Both are read from the same figures: second differences of means over 1, 2, 4, ... samples (octaves). For
// white noise and a random walk of ratio = q dt / R the octave of m samples has the variance R (6 / m + ratio m).
// A stretch of some thousand samples is noise if every octave agrees within chance: shaking whose angle is
// bounded falls faster with m, and turns rise. The ratio is that of all stretches that were noise, by
// the octaves from 64 samples on, which the colour of an output filter does not reach: their mean, each weighted by
// its likelihood. Where a record is too short to show a walk, that is one that it just hides: a filter that is a
// little too quick is a little noisier, one that is too slow takes the walk for motion. A motion that passes for rest
// makes the walk look quicker, never slower. So a stretch that is surely slower replaces what was known.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "filters/settings/axes.h"

namespace ifog {

// Driving noise of a sample over R, at most: ten thousand times any gyro's. What looks quicker is motion.
inline constexpr double kMostRatio = 1e-3;

class Walk {
 public:
  struct Found {
    Axes noise{};        // R of each axis in the last stretch, per sample, (rad/s)^2; 0: not known
    double ratio = 0.0;  // q dt / R
    bool white = false;  // from one sample on; else from eight on, and the noise is coloured
    double samples = 0.0;
  };

  // What an earlier run has found counts as so many samples of this one. noise: R of each axis, (rad/s)^2.
  void recall(const Axes& noise, double ratio, double samples) noexcept;
  // The next measurements, rad/s. The walk is learned only with `learn`.
  void take(const Axes& rate, std::uint32_t valid_axes, bool learn) noexcept;
  // A motion or a gap: the stretch begins again.
  void break_off() noexcept;
  // Samples that are judged together.
  void set_stretch(double samples) noexcept { stretch_ = samples; }
  // Once, when a stretch was judged to be noise.
  [[nodiscard]] std::optional<Found> take_news() noexcept;
  // Samples that the ratio stands on.
  [[nodiscard]] double samples() const noexcept { return samples_; }

 private:
  static constexpr double kStretch = 4096.0;  // octaves up to 256 samples, and R to 2 %
  static constexpr std::size_t kOctaves = 16;

  // Sum of squared second differences and their effective number, of each octave.
  struct Evidence {
    std::array<double, kOctaves> squares{}, count{};
    void add(const Evidence& other) noexcept;
  };
  // Means of the two blocks before, and of the first half of the next one.
  struct Octave {
    std::array<double, 2> means{};
    double half = 0.0;
    int blocks = 0;
    bool has_half = false;
  };
  struct Axis {
    std::array<Octave, kOctaves> octaves{};
    Evidence lately, all;
    double samples = 0.0;  // of this stretch
  };

  void judge() noexcept;
  void believe() noexcept;
  [[nodiscard]] static double misfit(const Evidence& evidence, double ratio) noexcept;
  [[nodiscard]] double likeliest(Evidence Axis::*of) const noexcept;
  [[nodiscard]] double mean_ratio() const noexcept;
  [[nodiscard]] double misfit(Evidence Axis::*of, double ratio) const noexcept;
  [[nodiscard]] static double white_noise(const Evidence& evidence, double ratio, std::size_t first) noexcept;

  std::array<Axis, kMaxAxes> axes_{};
  double stretch_ = kStretch, in_stretch_ = 0.0, samples_ = 0.0;
  double ratio_ = kMostRatio;
  bool learn_ = true;
  std::optional<Found> news_;
};

}  // namespace ifog
