// SPDX-License-Identifier: Apache-2.0
// The published gain at rest against the paper's equations, by the published innovations and the random weights of the
// numbers of their samples: with P- = P + Q (10) and C the weighted average of the last N squared innovations, K = P- / C
// and P = K (C - P-).
#include <gtest/gtest.h>

#include <cmath>
#include <deque>
#include <utility>

#include "filters/random/deviates.h"
#include "tests/unit/estimator/drive.h"

namespace ifog::test {
namespace {

constexpr std::size_t kWindow = 1000;
constexpr double kNoise = 1e-6;  // rad/s
constexpr int kSettled = 2000;  // samples in which a covariance that begins elsewhere has become the filter's

// Largest relative difference at rest of the published gain and that of the equations.
double worst(const FilterSettings& settings, std::uint64_t seed, double walk_over_noise) {
  const Record made = record(seed, 12'000, walk_over_noise);
  Fed filter(settings);
  DeviateStream weights(settings.seed, 0, DeviateStream::Law::kExponential);
  std::deque<std::pair<double, double>> window;  // weight, squared innovation
  double p = std::sqrt(walk_over_noise), far = 0.0;
  int compared = 0;
  for (std::size_t i = 0; i < made.measured.size(); ++i) {
    const EstimatorOutput& out = filter.step({kNoise * made.measured[i]});
    const double innovation = out.innovation_radps[0] / kNoise;
    window.emplace_back(weights.at(i, 0), innovation * innovation);
    if (window.size() > kWindow) window.pop_front();
    if (window.size() < kWindow) continue;
    double sum = 0.0, weighted = 0.0;
    for (const auto& [weight, square] : window) {
      sum += weight;
      weighted += weight * square;
    }
    const double c = weighted / sum, predicted = p + walk_over_noise, gain = predicted / c;
    p = gain * (c - predicted);
    if (static_cast<int>(i) < static_cast<int>(kWindow) + kSettled ||
        (!settings.plain && (out.flags & kAtRest) == 0))
      continue;
    ++compared;
    far = std::max(far, std::abs(out.gain[0] / gain - 1.0));
  }
  EXPECT_GT(compared, 8000);
  return far;
}

FilterSettings told_quiet(double walk_over_noise) {
  return told(walk_over_noise * kNoise * kNoise, kNoise * kNoise);
}

TEST(GainAtRest, IsThatOfThePapersEquations) {
  for (const std::uint64_t seed : {41U, 42U, 43U})
    EXPECT_LT(worst(told_quiet(1e-3), seed, 1e-3), 1e-9) << seed;
  FilterSettings plain = told_quiet(1e-3);
  plain.plain = true;
  plain.window = static_cast<int>(kWindow);
  EXPECT_LT(worst(plain, 44, 1e-3), 1e-9);
}

}  // namespace
}  // namespace ifog::test
