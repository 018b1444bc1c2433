// SPDX-License-Identifier: Apache-2.0
// The level of a sensor at rest, by the means of blocks of its samples: what the next mean should be, and how
// far off it may be. White noise, bias instability (1/f) and rate random walk, each as large as all that has
// come makes it likely.
//
// The state is one Gauss-Markov process a decade of time, from one block to 10 000, of equal variance, whose
// sum has a spectrum of 1/f between (M. S. Keshner, Proc. IEEE 70, 1982), and a walk, whose start is
// anybody's guess. A Kalman filter for each pair of a table of ratios to the white noise (level_filter.h);
// the likelihood chooses, for as long as the sensor rests: what is learned in an hour is a guess compared with what
// days show.
#pragma once

#include <cstddef>
#include <vector>

#include "daemon/health/level_filter.h"

namespace ifog {

class LevelNoise {
 public:
  static constexpr std::size_t kStates = LevelFilter::kStates;
  using Vector = LevelFilter::Vector;
  struct Innovation {
    bool known = false;
    double value = 0.0;   // of variance 1
    double spread = 0.0;  // its standard deviation, in the unit of the means
    double scale = 1.0;   // the same in that of the white noise
    Vector keep{};        // what became of each state since the mean before
    Vector gain{};        // how much of the innovation each state takes
  };

  LevelNoise();
  // The next mean, `blocks` after the one before (1: its neighbour).
  const Innovation& take(double mean, double blocks) noexcept;
  // The level is anybody's guess from here on; what is known of the noise stays.
  void forget_level() noexcept { has_level_ = false; }
  [[nodiscard]] double level() const noexcept;
  [[nodiscard]] double blocks() const noexcept { return count_; }
  // In units of the white noise of a block's mean: variance of a decade of the bias instability; variance of
  // the walk's step from block to block.
  [[nodiscard]] double instability() const noexcept { return filters_[chosen_].ratios().instability; }
  [[nodiscard]] double walk() const noexcept { return filters_[chosen_].ratios().walk; }

 private:
  void innovate(double squares) noexcept;
  void choose() noexcept;
  std::vector<LevelFilter> filters_;
  Innovation innovation_;
  std::size_t chosen_ = 0;
  double count_ = 0.0, chosen_at_ = 0.0;
  bool has_level_ = false;
};

}  // namespace ifog
