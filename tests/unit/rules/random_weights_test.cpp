// SPDX-License-Identifier: Apache-2.0
// The random weights against the moments of the Dirichlet law, and the variance of the covariance they
// estimate against what follows from it: for independent innovations whose square has variance t^2, a plain
// window of n has t^2 / n, one Dirichlet draw t^2 E(sum w^2) = 2 t^2 / (n + 1), B draws t^2 (1/n + (2/(n+1) -
// 1/n) / B).
#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filters/random/deviates.h"
#include "filters/rules/rule.h"

namespace {

TEST(DirichletWeights, HaveTheLawsMoments) {
  constexpr std::size_t kN = 5;
  constexpr int kDraws = 400'000;
  const ifog::DeviateStream stream(11, 0, ifog::DeviateStream::Law::kExponential);
  std::array<double, kN> e{};
  double mean = 0.0, square = 0.0, product = 0.0;
  for (int draw = 0; draw < kDraws; ++draw) {
    stream.fill(static_cast<std::uint64_t>(draw), 0, e);
    double sum = 0.0;
    for (const double v : e) sum += v;
    mean += e[0] / sum;
    square += (e[0] / sum) * (e[0] / sum);
    product += (e[0] / sum) * (e[1] / sum);
  }
  const double n = kN;
  mean /= kDraws;
  EXPECT_NEAR(mean, 1 / n, 0.002 / n);
  EXPECT_NEAR(square / kDraws - mean * mean, (n - 1) / (n * n * (n + 1)), 0.01 * (n - 1) / (n * n * (n + 1)));
  EXPECT_NEAR(product / kDraws - mean * mean, -1 / (n * n * (n + 1)), 0.05 / (n * n * (n + 1)));
}

struct Spread {
  double mean = 0.0, variance = 0.0;
};

// Statistics of the estimated covariance over many independent windows of unit normal innovations.
Spread spread(const char* rule_name, const char* weights, int draws, int window) {
  ifog::FilterSettings settings;
  settings.rule = rule_name;
  settings.weights = weights;
  settings.draws = draws;
  settings.window = window;
  settings.floor = 0.0;
  settings.process_noise = settings.measurement_noise = 1.0;
  const auto rule = ifog::make_rule(settings);
  std::mt19937_64 random(3);
  std::normal_distribution<double> normal;
  constexpr int kWindows = 40'000;
  double sum = 0.0, squares = 0.0;
  std::uint64_t sequence = 0;
  for (int w = 0; w < kWindows; ++w) {
    double c = 0.0;
    for (int i = 0; i < window; ++i) {
      const double innovation = normal(random);
      c = rule->innovation_covariance({0.0, 1.0, {&innovation, 1}, sequence++, 0});
    }
    sum += c;
    squares += c * c;
  }
  const double mean = sum / kWindows;
  return {mean, squares / kWindows - mean * mean};
}

TEST(RandomWeighting, HasTheVarianceThatFollowsFromTheWeights) {
  constexpr int kWindow = 20;
  constexpr double n = kWindow;
  constexpr double kTau2 = 2.0;  // variance of the square of a unit normal
  const double one_draw = 2 * kTau2 / (n + 1);
  const auto expect = [](const Spread& got, double variance) {
    EXPECT_NEAR(got.mean, 1.0, 5 * std::sqrt(variance / 40'000));
    EXPECT_NEAR(got.variance / variance, 1.0, 0.05);
  };
  expect(spread("iae", "kept", 1, kWindow), kTau2 / n);
  expect(spread("irwe-akfg", "kept", 1, kWindow), one_draw);
  expect(spread("irwe-akfg", "fresh", 1, kWindow), one_draw);
  expect(spread("irwe-akfg", "kept", 4, kWindow), kTau2 / n + (one_draw - kTau2 / n) / 4);
  expect(spread("irwe-akfg", "fresh", 4, kWindow), kTau2 / n + (one_draw - kTau2 / n) / 4);
  // Uniform weights: sum w^2 has no closed mean; E u^2 / (n (E u)^2) = 4 / (3 n) is its limit, good to 1/n.
  expect(spread("irwe-akfg", "uniform", 1, kWindow), kTau2 * 4 / (3 * n));
}

TEST(RandomWeighting, FloorIsCountedAndCanBeSwitchedOff) {
  ifog::FilterSettings settings;
  settings.window = 2;
  settings.measurement_noise = settings.process_noise = 1.0;
  for (const double floor : {0.01, 0.0}) {
    settings.floor = floor;
    const auto rule = ifog::make_rule(settings);
    const double tiny = 1e-6;
    double c = 0.0;
    for (std::uint64_t i = 0; i < 3; ++i) c = rule->innovation_covariance({0.5, 1.0, {&tiny, 1}, i, 0});
    EXPECT_EQ(rule->floor_hits(), floor > 0 ? 2U : 0U);
    EXPECT_NEAR(c, floor > 0 ? 0.51 : 1e-12, 1e-12);
  }
}

}  // namespace
