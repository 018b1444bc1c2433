// SPDX-License-Identifier: Apache-2.0
// What a stream says of a sensor's noise: how strong the white noise of each axis is, and how quickly the
// rate walks.
//
// One learner for the start, for rest, and for louder noise. A stretch of some thousand samples is judged as
// a whole. It is noise if it is white over every octave: the second difference of block means over m samples
// has the variance R (6 / m + ratio m), ratio = q dt / R <= 1e-3, within chance at each m from one sample to
// a sixteenth of the stretch. Shaking whose angle is bounded falls faster with m, turns rise, and neither is
// taken for noise.
//
// The walk is found by its likelihood: for each ratio on a grid a Kalman filter runs over means of 64
// samples, and R is left open. Of ratios nearly as likely as the best the quickest is taken, as a filter that
// is a little too quick is a little noisier and one that is too slow takes the walk for motion. A motion that
// passes for rest makes the walk look quicker, never slower: so a stretch that is surely slower replaces what
// was known, one surely quicker is dropped.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "filters/settings/axes.h"

namespace ifog {

// Driving noise of a sample over R, at most: ten thousand times any gyro's. What looks quicker is a motion.
inline constexpr double kMostRatio = 1e-3;

class Walk {
 public:
  struct Found {
    Axes noise{};        // R of each axis in the last stretch, per sample, (rad/s)^2; 0: not known
    double ratio = 0.0;  // q dt / R
    bool white = false;  // from one sample on; else from eight on, and the noise is coloured
    double samples = 0.0;
  };

  // Samples of a stretch at rest: octaves up to 256 samples, and R to 2 %.
  static constexpr double kStretch = 4096.0;

  // A stretch has so many samples.
  explicit Walk(double stretch = kStretch) noexcept;
  // The walk as an earlier run has found it, in so many samples. Doubted by a slower stretch, or 64 quicker.
  void recall(double ratio, double samples) noexcept;
  // The next measurements, rad/s. What is learned of the walk is learned only with `learn`.
  void take(const Axes& rate, std::uint32_t valid_axes, bool learn) noexcept;
  // A motion or a gap: the stretch begins anew.
  void break_off() noexcept;
  void set_stretch(double samples) noexcept { stretch_ = samples; }
  // Once, when a stretch was judged to be noise.
  [[nodiscard]] std::optional<Found> take_news() noexcept;
  // Samples that the ratio stands on.
  [[nodiscard]] double samples() const noexcept { return samples_; }

 private:
  static constexpr std::size_t kOctaves = 16, kTrials = 33;

  struct Octave {
    std::array<double, 2> means{};
    double half = 0.0;
    int blocks = 0;
    bool has_half = false;
    double squares = 0.0, count = 0.0;
  };
  struct Level {
    double value = 0.0, variance = -1.0;  // below 0: not known
  };
  struct Likelihood {
    std::array<double, kTrials> squares{}, logs{};
    double count = 0.0;
    void add(const Likelihood& other) noexcept;
    [[nodiscard]] double misfit(std::size_t k) const noexcept;
  };
  struct Axis {
    std::array<Octave, kOctaves> octaves{};
    std::array<Level, kTrials> levels{};
    double sum = 0.0, mean = 0.0, samples = 0.0;
    int in_block = 0;
    std::size_t next = kTrials;  // trial that `mean` is worked into at the next sample
    Likelihood lately, all;
  };

  void add_octaves(Axis& axis, double rate) noexcept;
  void add_block(Axis& axis, double rate) noexcept;
  void work_in(Axis& axis) noexcept;
  void judge() noexcept;
  [[nodiscard]] double white_noise(const Axis& axis, double ratio, std::size_t first) const noexcept;
  void believe() noexcept;
  // nearly: the quickest of those within so much of -2 log-likelihood.
  [[nodiscard]] std::size_t likeliest(Likelihood Axis::*of, double nearly) const noexcept;
  [[nodiscard]] double misfit(Likelihood Axis::*of, std::size_t k) const noexcept;

  std::array<double, kTrials> ratios_{};
  std::array<Axis, kMaxAxes> axes_{};
  double stretch_, in_stretch_ = 0.0, samples_ = 0.0;
  double ratio_ = kMostRatio;
  double recalled_ = 0.0, recalled_samples_ = 0.0;  // 0: not recalled
  int quicker_ = 0;                                 // stretches in a row
  bool learn_ = true;
  std::optional<Found> news_;
};

}  // namespace ifog
