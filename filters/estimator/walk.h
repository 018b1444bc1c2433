// SPDX-License-Identifier: Apache-2.0
// Learns a sensor's noise from its data: white noise of each axis and the random walk of the rate.
//
// Used at the start, at rest, and for higher noise. README.md says which stretch is noise. The walk is the ratio
// q dt / R, on a grid, with the largest likelihood of the long octaves over a million samples; R is free.
#pragma once

#include <array>
#include <cstddef>
#include <cstdint>
#include <optional>

#include "filters/settings/axes.h"

namespace ifog {

// Upper limit of driving noise per sample / R: 10^4 times that of any gyro. Faster changes are motion.
inline constexpr double kMostRatio = 1e-3;

class Walk {
 public:
  struct Found {
    Axes noise{};        // R of each axis in the last stretch, per sample, (rad/s)^2; 0: unknown
    double ratio = 0.0;  // q dt / R
    bool white = false;  // white from one sample on; else from eight on, i.e. coloured
  };

  // Samples of a stretch at rest: octaves up to 256 samples, R to 2 %. It consists of pieces that follow each other or lie
  // between motions.
  static constexpr double kStretch = 4096.0, kPiece = 512.0;
  // Blocks of up to 5e5 samples, which show a walk of 1e-10.
  static constexpr std::size_t kOctaves = 20;

  // Samples of a stretch; not in pieces: they must follow each other.
  explicit Walk(double stretch = kStretch, bool in_pieces = true) noexcept;
  // Sets the ratio learned by an earlier run from `samples`; valid until this run has as many or contradicts
  // it.
  void recall(double ratio, double samples) noexcept;
  // Adds measurements, rad/s. If a stretch ends with them and is noise, returns its result.
  std::optional<Found> take(const Axes& rate, std::uint32_t valid_axes) noexcept;
  // Samples are missing here: no mean and no difference reaches across, and the piece goes on.
  void gap() noexcept { blocks_ = {}; }
  // The sensor moved here: the piece is of no use, those before it are.
  void moved() noexcept;
  // Number of samples behind the ratio.
  [[nodiscard]] double samples() const noexcept { return samples_ + recalled_samples_; }

 private:
  // Last mean of 2^k samples, and the first half of the next one.
  struct Block {
    double mean = 0.0, half = 0.0;
    bool has_mean = false, has_half = false;
  };
  // Allan variance of one axis by octave, times its number of independent differences.
  struct Allan {
    std::array<double, kOctaves> sums{}, counts{};
  };
  using Octaves = std::array<Allan, kMaxAxes>;

  // How the piece compares with the others: 1 if the noise of an octave is higher beyond chance, -1 if one is lower and none higher.
  [[nodiscard]] int against_others() const noexcept;
  void add(std::size_t axis, double rate) noexcept;
  static void merge(const Octaves& more, double kept, Octaves& into) noexcept;
  [[nodiscard]] std::optional<Found> judge() noexcept;
  // R of an axis if its noise is white plus this walk from octave `first` on; 0 if not, NaN if there are no
  // data.
  [[nodiscard]] static double white_noise(const Allan& allan, std::size_t trial, std::size_t first) noexcept;
  void believe() noexcept;
  // -2 log-likelihood of a ratio, with the most likely R of each axis.
  [[nodiscard]] static double misfit(const Octaves& of, std::size_t trial) noexcept;
  // Largest ratio whose misfit is within `nearly` of the smallest.
  [[nodiscard]] static std::size_t likeliest(const Octaves& of, double nearly) noexcept;

  std::array<std::array<Block, kOctaves>, kMaxAxes> blocks_{};
  Octaves piece_{}, lately_{}, all_{};
  double stretch_, of_piece_, in_piece_ = 0.0, in_stretch_ = 0.0, samples_ = 0.0;
  double ratio_ = kMostRatio;
  double recalled_samples_ = 0.0;  // samples of the recalled ratio_; 0: learned by this run
};

}  // namespace ifog
