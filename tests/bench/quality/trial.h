// SPDX-License-Identifier: Apache-2.0
// One record through one filter, and its errors.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/quality/regimes.h"

namespace ifog::bench {

// Estimates with the filter's own variances.
struct Filtered {
  std::vector<double> value, variance;  // σ, σ²
};

// The conventional scalar Kalman filter of a random walk, written by hand, with Q = `ratio` and R = 1: the
// reference. informed: it also knows each sample's variance and restarts at the start of rest.
Filtered conventional(const RegimeRecord& record, double ratio, bool informed);

// "default": the daemon's filter without a model file. "irwe-akfg-plain": the published rule. "ckf": the
// project's conventional filter. noise_given: with true Q and R; otherwise learned at start-up. Throws
// std::invalid_argument with the name of an unknown filter.
Filtered denoised(const std::string& filter, const RegimeRecord& record, double ratio, const Regime& regime);
const std::vector<std::string>& filter_names();

// Over the judged samples; infinite if an estimate is not finite or a variance is not positive.
struct Figures {
  double over_conventional = 0.0;  // RMSE relative to conventional()
  double over_raw = 0.0;
  double over_better = 0.0;            // relative to the better of conventional and raw
  double over_informed = 0.0;          // relative to the informed one; NaN if it knows no more
  double nees = 0.0;                   // mean of (estimate − truth)²/variance
  double nees_conventional = 0.0;      // the same for conventional()
  std::size_t settle = 0, judged = 0;  // samples
};

Figures judge(const Regime& regime, const std::string& filter, double ratio, std::uint64_t seed);

}  // namespace ifog::bench
