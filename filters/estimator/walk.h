// SPDX-License-Identifier: Apache-2.0
// What a stream says of a sensor's noise: how strong the white noise of each axis is, and how quickly the
// rate walks.
//
// One learner for the start, for rest, and for louder noise. A stretch of some thousand samples is judged as
// a whole by its Allan variance. It is noise if it is white over every octave: means over m samples have the
// Allan variance R / m + q dt m / 3, q dt <= 1e-3 R, within chance at each m from one sample to a sixteenth
// of the stretch. Shaking whose angle is bounded falls faster with m, turns rise, and neither is taken for
// noise.
//
// The walk is found by the likelihood of the long octaves, over the stretches of a million samples together, for
// each ratio q dt / R on a grid; R is left open. Of ratios nearly as likely as the best the quickest is taken, as
// a filter that is a little too quick is a little noisier and one that is too slow takes the walk for motion.
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
  };

  // Samples of a stretch at rest: octaves up to 256 samples, and R to 2 %.
  static constexpr double kStretch = 4096.0;
  // Blocks of up to 5e5 samples, in which a walk of 1e-10 shows.
  static constexpr std::size_t kOctaves = 20;

  // A stretch has so many samples.
  explicit Walk(double stretch = kStretch) noexcept;
  // The walk as an earlier run has found it, in so many samples: stands until this run has had as many or
  // contradicts it.
  void recall(double ratio, double samples) noexcept;
  // The next measurements, rad/s; returns what a stretch that ends with them shows, if it is noise. The walk is learned
  // only with `learn`.
  std::optional<Found> take(const Axes& rate, std::uint32_t valid_axes, bool learn) noexcept;
  // A motion or a gap: the stretch begins anew.
  void break_off() noexcept;
  void set_stretch(double samples) noexcept { stretch_ = samples; }
  // Samples that the ratio stands on.
  [[nodiscard]] double samples() const noexcept { return samples_ + recalled_samples_; }

 private:
  // The last mean of 2^k samples, and the first half of the next.
  struct Block {
    double mean = 0.0, half = 0.0;
    bool has_mean = false, has_half = false;
  };
  // Allan variance of one axis by octave, times how many independent differences it is of.
  struct Allan {
    std::array<double, kOctaves> sums{}, counts{};
  };
  using Octaves = std::array<Allan, kMaxAxes>;

  void add(std::size_t axis, double rate) noexcept;
  [[nodiscard]] std::optional<Found> judge() noexcept;
  // R of an axis if it is white noise and this walk from that octave on; 0 if it is not, NaN if nothing was
  // measured.
  [[nodiscard]] static double white_noise(const Allan& allan, std::size_t trial, std::size_t first) noexcept;
  void believe() noexcept;
  // -2 log-likelihood of a ratio, R of each axis being the likeliest.
  [[nodiscard]] static double misfit(const Octaves& of, std::size_t trial) noexcept;
  // nearly: the quickest of those within so much of the least misfit.
  [[nodiscard]] static std::size_t likeliest(const Octaves& of, double nearly) noexcept;

  std::array<std::array<Block, kOctaves>, kMaxAxes> blocks_{};
  Octaves lately_{}, all_{};
  double stretch_, in_stretch_ = 0.0, samples_ = 0.0;
  double ratio_ = kMostRatio;
  double recalled_samples_ = 0.0;  // that ratio_ was recalled with; 0: it is this run's
  bool learn_ = true;
};

}  // namespace ifog
