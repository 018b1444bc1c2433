// SPDX-License-Identifier: Apache-2.0
// Detection by a scan that knows the noise but not the time of the step: windows of several lengths end at
// the newest block and are weighted with the signal of a step at their beginning. Simulates white
// innovations, also for the thresholds; ifog::exceeded_per_block() is an independent method for these.
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
  // left: signal of the step in the innovations from its first block on, in standard deviations.
  StepScan(std::vector<double> left, std::vector<Window> windows, bool either_sign);

  // Simulates blocks without a step, a multiple of kChunk.
  void watch_nothing(std::size_t blocks, std::mt19937_64& random);
  // Afterwards: threshold on the formula's rate for this frequency of false alarms.
  [[nodiscard]] double level(double alarms_per_block) const;
  // Frequency of false alarms for a threshold on the formula's rate.
  [[nodiscard]] double alarms_per_block(double level) const;
  // Fraction of steps found within `looks` blocks. The step begins at the start of the first block, or at a
  // random time in it.
  [[nodiscard]] double found(double level, std::size_t looks, bool anywhere, std::size_t trials,
                             std::mt19937_64& random) const;

  static constexpr std::size_t kChunk = 2000;

 private:
  [[nodiscard]] double rarest(const std::vector<float>& innovations, std::size_t looks) const;
  std::vector<double> left_;
  std::vector<Window> windows_;
  std::vector<std::vector<float>> weights_;
  std::vector<double> anew_;  // 1 minus the correlation of neighbours
  std::size_t longest_ = 0;
  bool either_sign_;
  std::vector<double> chunks_;  // the smallest of each chunk, sorted
};

}  // namespace ifog::bench
