// SPDX-License-Identifier: Apache-2.0
// The noise of a gyro as it is seen in means over some seconds, and below.
#pragma once

#include <random>
#include <string>
#include <vector>

namespace ifog::bench {

// Coefficients of IEEE Std 952, any unit of rate: N in unit sqrt(s), B, K in unit / sqrt(s).
struct NoiseKind {
  std::string name;
  double N = 1.0, B = 0.0, K = 0.0;
};

// Bias instability and rate random walk, step by step.
class SlowNoise {
 public:
  SlowNoise(const NoiseKind& kind, double step_s, std::mt19937_64& random);
  double next(std::mt19937_64& random);
  struct Markov {
    double keep, drive, value;
  };
  // What it is made of, beside the walk.
  [[nodiscard]] const std::vector<Markov>& processes() const { return processes_; }

 private:
  std::vector<Markov> processes_;
  double walk_ = 0.0, walk_step_;
  std::normal_distribution<double> normal_;
};

}  // namespace ifog::bench
