// SPDX-License-Identifier: Apache-2.0
// Whether a level has stepped, by what a step leaves in the innovations of the filter that follows the level:
// they are off by the step, and from block to block by less, as the filter takes its gain of it. Windows of
// several lengths that end at the newest block are tested, each weighted by that response, which is the
// likelihood ratio of a step at its beginning.
//
// Each length has its share of the false alarms, the longest nine tenths: it decides what is found within ten
// minutes. The others find larger steps sooner, which stand out enough for the little that they are given.
// Windows of one length that begin at neighbouring blocks are correlated by 1 - s; a value z is then
// exceeded, on either side, so many times a block (D. Siegmund and B. Yakir, The Statistics of Gene Mapping,
// 2007, and as an asymptote in D. Siegmund, Sequential Analysis, 1985):
//
//   2 z phi(z) s nu(z sqrt(2 s)),   nu(x) = (2 / x) (Phi(x / 2) - 1/2) / ((x / 2) Phi(x / 2) + phi(x / 2))
#pragma once

#include <array>
#include <cstddef>

#include "daemon/health/level_noise.h"

namespace ifog {

// How often a block, on average, a new excess of |z| begins; s: 1 less the correlation of neighbours, in (0, 1]. z
// > 1.
[[nodiscard]] double exceeded_per_block(double z, double s);

class StepTest {
 public:
  // In blocks. The longest leaves a minute of ten for a step that comes in the middle of a block.
  static constexpr std::array<std::size_t, 7> kLengths{1, 2, 4, 8, 15, 30, 58};
  static constexpr std::array<double, 7> kShares{0.01, 0.01, 0.01, 0.01, 0.02, 0.04, 0.9};

  // A false alarm in so many blocks.
  explicit StepTest(double blocks_between_alarms) : alarms_per_block_(1.0 / blocks_between_alarms) {}
  // True: a step is found, and the test restarts.
  bool take(const LevelNoise::Innovation& innovation) noexcept;
  // The step that was found last, in the unit of the means.
  [[nodiscard]] double step() const noexcept { return step_; }
  // The least share of false alarms that something since restart() would have been one of: 1 or less is an
  // alarm.
  [[nodiscard]] double nearest() const noexcept { return nearest_; }
  // What begins now has nothing to do with what was before; the variance of sums stays known.
  void restart() noexcept;
  // Nor does what sums vary by.
  void forget() noexcept;

 private:
  struct Window {
    LevelNoise::Vector absorbed{};  // by each state, of a step of one
    double sum = 0.0, squares = 0.0, neighbours = 0.0, weight = 0.0;
  };
  // Variance of the sums over windows of one length, relative to that of white innovations.
  struct Spread {
    double mean_square = 1.0, count = 0.0, latest = 0.0;
  };
  static constexpr double kFar = 1e9;
  static constexpr std::size_t kLongest = kLengths.back();
  static void extend(Window& window, const LevelNoise::Innovation& innovation) noexcept;
  double look(std::size_t number) noexcept;
  [[nodiscard]] double likeliest(std::size_t in_use) const noexcept;

  double alarms_per_block_, step_ = 0.0, nearest_ = kFar;
  std::array<Window, kLongest> windows_{};  // by the number of their first block, modulo
  std::array<Spread, kLengths.size()> spreads_{};
  std::size_t begun_ = 0;  // in all
};

}  // namespace ifog
