// SPDX-License-Identifier: Apache-2.0
// Kalman filter of a level, for given ratios to the white noise of a block's mean: variance per decade of
// bias instability, and variance of the walk's step per block.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace ifog {

class LevelFilter {
 public:
  // One Gauss-Markov process per decade, and the walk.
  static constexpr std::size_t kStates = 6;
  using Vector = std::array<double, kStates>;
  struct Ratios {
    double instability = 0.0, walk = 0.0;
  };

  explicit LevelFilter(Ratios ratios) : ratios_(ratios) {}
  // Forgets the level except for this mean; keeps the likelihood.
  void begin(double mean) noexcept;
  // keep: decay of each state over the blocks. The mean's square is limited to most_squares times the mean
  // square of `count`.
  void take(double mean, double blocks, const Vector& keep, double count, double most_squares) noexcept;

  // Innovation of the last mean, and its variance in units of the white noise.
  [[nodiscard]] double innovation() const noexcept { return innovation_; }
  [[nodiscard]] double total() const noexcept { return total_; }
  [[nodiscard]] Vector gain() const noexcept;
  [[nodiscard]] double level() const noexcept;
  // Sum of squared innovations / `total`, and of log `total`.
  [[nodiscard]] double squares() const noexcept { return squares_; }
  [[nodiscard]] double log_variance() const noexcept { return logs_; }

 private:
  void predict(const Vector& keep, double blocks) noexcept;
  void update(double mean) noexcept;

  Ratios ratios_;
  Vector state_{}, of_sum_{};  // of_sum: covariance with the level
  std::array<Vector, kStates> covariance_{};
  double innovation_ = 0.0, total_ = 0.0, squares_ = 0.0, logs_ = 0.0;
};

}  // namespace ifog
