// SPDX-License-Identifier: Apache-2.0
// One record through one filter, and what came of it.
#pragma once

#include <cstdint>
#include <string>
#include <vector>

#include "tests/bench/quality/regimes.h"

namespace ifog::bench {

// An estimate of every sample with the variance the filter itself gives for it.
struct Filtered {
  std::vector<double> value, variance;  // σ, σ²
};

// The conventional Kalman filter of a random walk, scalar, by hand, told Q = `ratio` and R = 1: what
// everything is measured against. informed: told the variance of each sample, and started afresh when rest
// has come, too.
Filtered conventional(const RegimeRecord& record, double ratio, bool informed);

// "default": the daemon's filter as it is without a model file. "irwe-akfg-plain": the paper's rule and
// nothing else. "ckf": the project's conventional filter. told: of the true Q and R; else it learns them at
// start-up. Throws std::invalid_argument naming the filter.
Filtered denoised(const std::string& filter, const RegimeRecord& record, double ratio, const Regime& regime);
const std::vector<std::string>& filter_names();

// Over the samples judged. Of an estimate that is not finite, or has no positive variance, they are infinite.
struct Figures {
  double over_conventional = 0.0;  // RMSE over that of conventional()
  double over_raw = 0.0;
  double over_better = 0.0;            // over the better of conventional and raw
  double over_informed = 0.0;          // over that of the informed one; NaN: nothing to be told
  double nees = 0.0;                   // mean of (estimate − truth)²/variance
  double nees_conventional = 0.0;      // the same of conventional()
  std::size_t settle = 0, judged = 0;  // samples
};

Figures judge(const Regime& regime, const std::string& filter, double ratio, std::uint64_t seed);

}  // namespace ifog::bench
