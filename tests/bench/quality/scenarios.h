// SPDX-License-Identifier: Apache-2.0
// The motions of the quality study, in units of the measurement noise and in samples.
#pragma once

#include <cstdint>
#include <span>
#include <string>
#include <vector>

namespace ifog::bench {

struct Scenario {
  const char* name;
  double (*motion)(int sample);
};

std::span<const Scenario> scenarios();

struct Record {
  std::vector<double> truth, measured;
};

// A random walk of variance `ratio` per step in unit noise, plus the motion. correlation: lag-1
// autocorrelation of the noise, an AR(1) process.
Record make_record(const Scenario& scenario, std::uint64_t seed, int samples, double ratio,
                   double correlation = 0.0);

// The scalar Kalman filter with true Q and R, without motion, written by hand: the reference for every rule.
std::vector<double> told_the_truth(const std::vector<double>& measured, double ratio);

}  // namespace ifog::bench
