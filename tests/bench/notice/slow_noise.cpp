// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/notice/slow_noise.h"

#include <cmath>
#include <numbers>

namespace ifog::bench {
namespace {

constexpr double kDay_s = 86400.0, kHour_s = 3600.0;

}  // namespace

// Bias instability, S(f) = B^2 / (2 pi f) two-sided, as Gauss-Markov processes of equal variance s^2 whose
// time constants are half a decade apart: together 4 pi s^2 / (w ln 10) one-sided, which is 2 B^2 / w.
SlowNoise::SlowNoise(const NoiseKind& kind, double step_s, std::mt19937_64& random)
    : walk_step_(kind.K * std::sqrt(step_s)), day_(kind.day), hour_(kind.hour), step_s_(step_s) {
  if (kind.B == 0.0) return;
  const double variance = kind.B * kind.B * std::numbers::ln10 / (2.0 * std::numbers::pi);
  for (double decade = 0.0; decade <= 7.0; decade += 0.5) {
    const double keep = std::exp(-step_s / std::pow(10.0, decade));
    processes_.push_back(
        {keep, std::sqrt(variance * (1.0 - keep * keep)), std::sqrt(variance) * normal_(random)});
  }
}

// A Gauss-Markov process of variance 2 through a low-pass of its own time constant has variance 1.
double SlowNoise::temperature(std::mt19937_64& random) {
  if (day_ == 0.0 && hour_ == 0.0) return 0.0;
  const double keep = std::exp(-step_s_ / kHour_s);
  room_ = keep * room_ + std::sqrt(2.0 * (1.0 - keep * keep)) * normal_(random);
  sensor_ += (1.0 - keep) * (room_ - sensor_);
  time_s_ += step_s_;
  return day_ * std::sin(2.0 * std::numbers::pi * time_s_ / kDay_s) + hour_ * sensor_;
}

double SlowNoise::next(std::mt19937_64& random) {
  walk_ += walk_step_ == 0.0 ? 0.0 : walk_step_ * normal_(random);
  double sum = walk_ + temperature(random);
  for (Markov& process : processes_)
    sum += process.value = process.keep * process.value + process.drive * normal_(random);
  return sum;
}

}  // namespace ifog::bench
