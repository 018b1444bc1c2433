// SPDX-License-Identifier: Apache-2.0
// A Kalman filter of one level, for a pair of ratios to the white noise of a block's mean: the variance of a decade of
// bias instability, and of a walk's step from block to block.
#pragma once

#include <array>
#include <cmath>
#include <cstddef>

namespace ifog {

class LevelFilter {
 public:
  // One Gauss-Markov process a decade, and the walk.
  static constexpr std::size_t kStates = 6;
  using Vector = std::array<double, kStates>;
  struct Ratios {
    double instability = 0.0, walk = 0.0;
  };

  explicit LevelFilter(Ratios ratios) : ratios_(ratios) {}
  // The level is unknown but for this mean; what made the filter likely stays.
  void begin(double mean) noexcept;
  // keep: what becomes of each state in so many blocks. A mean counts for most_squares times the
  // mean square of `count` at most.
  void take(double mean, double blocks, const Vector& keep, double count, double most_squares) noexcept;

  [[nodiscard]] const Ratios& ratios() const noexcept { return ratios_; }
  // The last mean's innovation, and its variance in units of the white noise.
  [[nodiscard]] double innovation() const noexcept { return innovation_; }
  [[nodiscard]] double total() const noexcept { return total_; }
  [[nodiscard]] Vector gain() const noexcept;
  [[nodiscard]] double level() const noexcept;
  // Sum of squares of innovations over `total`, and of log `total`.
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
