// SPDX-License-Identifier: Apache-2.0
// Level of a sensor at rest from block means: prediction of the next mean and its uncertainty. White noise,
// bias instability (1/f) and rate random walk, each with its most likely size.
//
// States: one Gauss-Markov process per decade of time, from one block to 10 000, with equal variance, whose
// sum has a 1/f spectrum between (M. S. Keshner, Proc. IEEE 70, 1982); and a diffuse walk. One Kalman filter
// for each pair of noise ratios in a table; the likelihood over the whole rest chooses.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace ifog {

class LevelNoise {
 public:
  // One Gauss-Markov process per decade, and the walk.
  static constexpr std::size_t kStates = 6;
  using Vector = std::array<double, kStates>;
  struct Innovation {
    bool known = false;
    double value = 0.0;   // with variance 1
    double spread = 0.0;  // its standard deviation, in the unit of the means
    double scale = 1.0;   // the same in units of the white noise
    Vector keep{};        // decay of each state since the previous mean
    Vector gain{};        // gain of each state
  };

  LevelNoise();
  // Adds the next mean, `blocks` after the previous one (1: adjacent).
  const Innovation& take(double mean, double blocks) noexcept;
  // Forgets the level; keeps the knowledge of the noise.
  void forget_level() noexcept { has_level_ = false; }
  [[nodiscard]] double level() const noexcept;
  [[nodiscard]] double blocks() const noexcept { return count_; }

 private:
  // Kalman filter for given ratios to the white noise of a block's mean.
  struct Filter {
    double instability, walk;  // variance per decade of bias instability; of the walk's step per block
    Vector state{};
    std::array<Vector, kStates> covariance{};
    // Of the last mean: the innovation, its variance in units of the white noise, and the gain of each state.
    double innovation = 0.0, total = 0.0;
    Vector gain{};
    double squares = 0.0, logs = 0.0;  // sums of squared innovations / `total`, and of log `total`

    // Forgets the level except for this mean; keeps the likelihood.
    void begin(double mean) noexcept;
    // keep: decay of each state over the blocks.
    void take(double mean, double blocks, const Vector& keep, double count) noexcept;
  };
  void innovate(double squares) noexcept;
  void choose() noexcept;
  std::vector<Filter> filters_;
  Innovation innovation_;
  std::size_t chosen_ = 0;
  double count_ = 0.0, chosen_at_ = 0.0;
  bool has_level_ = false;
};

}  // namespace ifog
