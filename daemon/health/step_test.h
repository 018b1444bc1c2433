// SPDX-License-Identifier: Apache-2.0
// Detects a step of a level from the innovations of the filter that tracks it: they are off by the step,
// decreasing from block to block as the filter follows. Windows of several lengths that end at the newest
// block are tested, weighted by that response (likelihood ratio of a step at the window's start).
//
// Each length has a share of the false alarms, the longest 90 %: it determines what is found within ten
// minutes. Shorter ones find larger steps sooner. Windows of one length that start at neighbouring blocks
// correlate by 1 - s; then |z| is exceeded this often per block (D. Siegmund and B. Yakir, The Statistics of
// Gene Mapping, 2007; asymptotically D. Siegmund, Sequential Analysis, 1985):
//
//   2 z phi(z) s nu(z sqrt(2 s)),   nu(x) = (2 / x) (Phi(x / 2) - 1/2) / ((x / 2) Phi(x / 2) + phi(x / 2))
#pragma once

#include <array>
#include <cstddef>

#include "daemon/health/level_noise.h"

namespace ifog {

class StepTest {
 public:
  // Mean number of blocks between false alarms.
  explicit StepTest(double blocks_between_alarms) : alarms_per_block_(1.0 / blocks_between_alarms) {}
  // True: a step is found, and the test restarts.
  bool take(const LevelNoise::Innovation& innovation) noexcept;
  // Last step found, in the unit of the means.
  [[nodiscard]] double step() const noexcept { return step_; }
  // Starts new windows; keeps the variance of sums.
  void restart() noexcept { begun_ = 0; }

 private:
  struct Window {
    LevelNoise::Vector absorbed{};  // by each state, of a unit step
    double sum = 0.0, squares = 0.0, neighbours = 0.0, weight = 0.0;
  };
  // Variance of the sums over windows of one length / that of white innovations.
  struct Spread {
    double mean_square = 1.0, count = 0.0, latest = 0.0;
  };
  // In blocks. The longest leaves one of ten minutes for a step within a block.
  static constexpr std::array<std::size_t, 7> kLengths{1, 2, 4, 8, 15, 30, 58};
  static constexpr std::array<double, 7> kShares{0.01, 0.01, 0.01, 0.01, 0.02, 0.04, 0.9};
  static constexpr std::size_t kLongest = kLengths.back();
  static void extend(Window& window, const LevelNoise::Innovation& innovation) noexcept;
  double look(std::size_t number) noexcept;
  [[nodiscard]] double likeliest(std::size_t in_use) const noexcept;

  double alarms_per_block_, step_ = 0.0;
  std::array<Window, kLongest> windows_{};  // by the number of their first block, modulo
  std::array<Spread, kLengths.size()> spreads_{};
  std::size_t begun_ = 0;  // total number
};

}  // namespace ifog
