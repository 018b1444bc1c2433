// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/notice/slow_noise.h"

#include <cmath>
#include <numbers>

namespace ifog::bench {

// Bias instability, S(f) = B^2 / (2 pi f) two-sided, as Gauss-Markov processes of equal variance s^2 whose
// time constants are half a decade apart: together 4 pi s^2 / (w ln 10) one-sided, which is 2 B^2 / w.
SlowNoise::SlowNoise(const NoiseKind& kind, double step_s, std::mt19937_64& random)
    : walk_step_(kind.K * std::sqrt(step_s)) {
  if (kind.B == 0.0) return;
  const double variance = kind.B * kind.B * std::numbers::ln10 / (2.0 * std::numbers::pi);
  for (double decade = 0.0; decade <= 7.0; decade += 0.5) {
    const double keep = std::exp(-step_s / std::pow(10.0, decade));
    processes_.push_back(
        {keep, std::sqrt(variance * (1.0 - keep * keep)), std::sqrt(variance) * normal_(random)});
  }
}

double SlowNoise::next(std::mt19937_64& random) {
  double sum = walk_ += walk_step_ == 0.0 ? 0.0 : walk_step_ * normal_(random);
  for (Markov& process : processes_)
    sum += process.value = process.keep * process.value + process.drive * normal_(random);
  return sum;
}

}  // namespace ifog::bench
