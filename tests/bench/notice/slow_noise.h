// SPDX-License-Identifier: Apache-2.0
// Noise of a gyro in means over some seconds and longer.
#pragma once

#include <random>
#include <string>
#include <vector>

namespace ifog::bench {

// Coefficients of IEEE Std 952, any unit of rate: N in unit sqrt(s), B, K in unit / sqrt(s).
struct NoiseKind {
  std::string name;
  double N = 1.0, B = 0.0, K = 0.0;
  // Temperature effect in the rate, in its unit: half the difference between day and night, and the standard
  // deviation of the hourly variation.
  double day = 0.0, hour = 0.0;
};

// Bias instability, rate random walk and temperature, step by step.
class SlowNoise {
 public:
  SlowNoise(const NoiseKind& kind, double step_s, std::mt19937_64& random);
  double next(std::mt19937_64& random);
  struct Markov {
    double keep, drive, value;
  };
  // Its processes except the random walk.
  [[nodiscard]] const std::vector<Markov>& processes() const { return processes_; }

 private:
  std::vector<Markov> processes_;
  double temperature(std::mt19937_64& random);
  double walk_ = 0.0, walk_step_;
  double day_, hour_, step_s_, time_s_ = 0.0;
  double room_ = 0.0, sensor_ = 0.0;  // the temperature, and the sensor's delayed one
  std::normal_distribution<double> normal_;
};

}  // namespace ifog::bench
