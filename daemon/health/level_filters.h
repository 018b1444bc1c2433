// SPDX-License-Identifier: Apache-2.0
// Kalman filters of one level, for every pair of a table of ratios to the white noise of a block's mean: the
// variance of a decade of bias instability, and of a walk's step from block to block. Side by side in lanes,
// which the compiler makes vectors of: some hundreds of filters a block cost a few microseconds.
#pragma once

#include <array>
#include <cstddef>
#include <vector>

namespace ifog {

class LevelFilters {
 public:
  // One Gauss-Markov process a decade, and the walk.
  static constexpr std::size_t kStates = 6;
  using Vector = std::array<double, kStates>;
  struct Ratios {
    double instability = 0.0, walk = 0.0;
  };

  explicit LevelFilters(const std::vector<Ratios>& table);
  [[nodiscard]] std::size_t size() const noexcept { return size_; }
  // The level is anybody's guess but for this mean; what made each filter likely stays.
  void begin(double mean) noexcept;
  // keep: what becomes of each state in so many blocks. A mean counts for most_squares times its filter's
  // mean square of `count` at most.
  void take(double mean, double blocks, const Vector& keep, double count, double most_squares) noexcept;

  [[nodiscard]] Ratios ratios(std::size_t i) const noexcept;
  // The last mean's innovation, and its variance in units of the white noise.
  [[nodiscard]] double innovation(std::size_t i) const noexcept { return lane(i).innovation[i % kLanes]; }
  [[nodiscard]] double total(std::size_t i) const noexcept { return lane(i).total[i % kLanes]; }
  [[nodiscard]] Vector gain(std::size_t i) const noexcept;
  [[nodiscard]] double level(std::size_t i) const noexcept;
  // Sum of squares of innovations over `total`, and of log `total`.
  [[nodiscard]] double squares(std::size_t i) const noexcept { return lane(i).squares[i % kLanes]; }
  [[nodiscard]] double log_variance(std::size_t i) const noexcept;

 private:
  static constexpr std::size_t kLanes = 8, kPairs = kStates * (kStates + 1) / 2;
  using Lane = std::array<double, kLanes>;
  struct Lanes {
    Lane instability{}, walk{};
    std::array<Lane, kStates> state{}, of_sum{};  // of_sum: covariance with the level
    std::array<Lane, kPairs> covariance{};        // lower triangle, row by row
    Lane innovation{}, total{}, squares{};
    Lane product{}, logs{};  // of totals: their logarithm is that of the product, and logs
  };
  [[nodiscard]] const Lanes& lane(std::size_t i) const noexcept { return lanes_[i / kLanes]; }
  static void begin(Lanes& at, double mean) noexcept;
  static void predict(Lanes& at, const Vector& keep, double blocks) noexcept;
  static void update(Lanes& at, double mean) noexcept;
  static void judge(Lanes& at, double count, double most_squares) noexcept;

  std::size_t size_;
  std::vector<Lanes> lanes_;
};

}  // namespace ifog
