// SPDX-License-Identifier: Apache-2.0
#include "tests/bench/quality/scenarios.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <numbers>
#include <random>

namespace ifog::bench {
namespace {

constexpr int kStart = 2000;  // at rest before the motion

double still(int) { return 0.0; }
double step20(int i) { return i >= kStart ? 20.0 : 0.0; }
double step5(int i) { return i >= kStart ? 5.0 : 0.0; }
double ramp(int i) { return i < kStart ? 0.0 : 0.05 * (std::min(i, 6000) - kStart); }
double sine(int i) {
  return i < kStart ? 0.0 : 100.0 * std::sin(2 * std::numbers::pi * (i - kStart) / 2000.0);
}
double small_sine(int i) {
  return i < kStart ? 0.0 : 5.0 * std::sin(2 * std::numbers::pi * (i - kStart) / 500.0);
}

// Dwells of 1000 samples with transitions of 50 samples, because a rate table has finite acceleration.
double table(int i) {
  constexpr std::array kLevels{0.0, 300.0, -300.0, 100.0, -50.0, 20.0, -20.0, 0.0};
  if (i < kStart) return 0.0;
  const auto dwell = static_cast<std::size_t>((i - kStart) / 1000);
  const int inside = (i - kStart) % 1000;
  const double from = kLevels[dwell % kLevels.size()];
  const double to = kLevels[(dwell + 1) % kLevels.size()];
  return inside < 50 ? from + (to - from) * inside / 50.0 : to;
}

constexpr std::array kScenarios{Scenario{"static", still},    Scenario{"step 20σ", step20},
                                Scenario{"step 5σ", step5},   Scenario{"ramp", ramp},
                                Scenario{"sine 100σ", sine},  Scenario{"sine 5σ", small_sine},
                                Scenario{"rate table", table}};

}  // namespace

std::span<const Scenario> scenarios() { return kScenarios; }

Record make_record(const Scenario& scenario, std::uint64_t seed, int samples, double ratio,
                   double correlation) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Record record;
  double walk = 0.0, noise = 0.0;
  for (int i = 0; i < samples; ++i) {
    if (i > 0) walk += std::sqrt(ratio) * normal(random);
    const double fresh = normal(random);
    noise = i == 0 ? fresh : correlation * noise + std::sqrt(1.0 - correlation * correlation) * fresh;
    record.truth.push_back(walk + scenario.motion(i));
    record.measured.push_back(record.truth.back() + noise);
  }
  return record;
}

std::vector<double> told_the_truth(const std::vector<double>& measured, double ratio) {
  std::vector<double> out{measured[0]};
  double x = measured[0], p = 1.0;
  for (std::size_t i = 1; i < measured.size(); ++i) {
    p += ratio;
    const double gain = p / (p + 1.0);
    x += gain * (measured[i] - x);
    p *= 1.0 - gain;
    out.push_back(x);
  }
  return out;
}

}  // namespace ifog::bench
