// SPDX-License-Identifier: Apache-2.0
// What a scan for a step can find that does not know when the step comes, but knows the noise: windows of
// some lengths that end at the newest block, each weighted by what a step at its beginning leaves in the
// innovations. By simulation of white innovations, thresholds included; ifog::exceeded_per_block() is the
// second method for them.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace ifog::bench {

class StepScan {
 public:
  struct Window {
    std::size_t blocks;
    double share;  // of the false alarms
  };
  // left: of the step in the innovations, block by block from the first on, in standard deviations.
  StepScan(std::vector<double> left, std::vector<Window> windows, bool either_sign);

  // Looks at so many blocks without a step, a multiple of kChunk.
  void watch_nothing(std::size_t blocks, std::mt19937_64& random);
  // Afterwards: how rare, by the formula, something must be for alarms to come so often.
  [[nodiscard]] double level(double alarms_per_block) const;
  // How often they come if something must be as rare as this by the formula.
  [[nodiscard]] double alarms_per_block(double level) const;
  // Share of steps found within `looks` blocks. The step begins at the beginning of the first, or anywhere
  // in it.
  [[nodiscard]] double found(double level, std::size_t looks, bool anywhere, std::size_t trials,
                             std::mt19937_64& random) const;

  static constexpr std::size_t kChunk = 2000;

 private:
  [[nodiscard]] double rarest(const std::vector<float>& innovations, std::size_t looks) const;
  std::vector<double> left_;
  std::vector<Window> windows_;
  std::vector<std::vector<float>> weights_;
  std::vector<double> anew_;  // 1 less the correlation of neighbours
  std::size_t longest_ = 0;
  bool either_sign_;
  std::vector<double> chunks_;  // the rarest of each, sorted
};

}  // namespace ifog::bench
