// SPDX-License-Identifier: Apache-2.0
// The regimes in which the denoised rate is judged: a true rate with a random walk of variance Q per sample,
// a motion, and measurement noise of variance R = 1 at rest, sampled at 200 Hz. Units of σ = √R.
#pragma once

#include <cstddef>
#include <cstdint>
#include <functional>
#include <string>
#include <vector>

#include "tests/bench/quality/motions.h"

namespace ifog::bench {

struct RegimeRecord {
  std::vector<double> truth;     // σ
  std::vector<double> measured;  // σ; NaN: missing
  std::size_t from = 0;          // first judged sample; all later ones are judged
};

struct Regime {
  std::string name;
  double limit = 0.0;              // of RMSE relative to the conventional filter
  double limit_at_laboratory = 0;  // the same at Q/R ≥ 5e-4; 0: the same
  bool judge_variance = false;     // the normalised squared error must be 0.8 … 1.25
  bool judge_against_raw = false;  // the limit also applies relative to the better of raw and conventional
  bool judge_raw_only = false;     // the limit applies to RMSE relative to raw, of the worst seed
  bool noise_given = true;         // Q and R are given; otherwise learned from the record
  double sample_rate_hz = kSampleRate_hz;
  std::string wideband = "motion";  // FilterSettings::wideband
  std::function<RegimeRecord(double ratio, std::uint64_t seed)> make;

  [[nodiscard]] double limit_at(double ratio) const {
    return limit_at_laboratory > 0.0 && ratio >= 5e-4 ? limit_at_laboratory : limit;
  }
};

// In the order of the table. ratio: Q/R, > 0 and ≤ 1. Each record depends on regime, ratio and seed only.
const std::vector<Regime>& regimes();

// Rounds to a multiple of `step`, ties to even.
double quantised(double value, double step);

}  // namespace ifog::bench
