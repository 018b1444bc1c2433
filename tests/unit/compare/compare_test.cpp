// SPDX-License-Identifier: Apache-2.0
#include "filters/compare/compare.h"
#include "filters/compare/figures.h"
#include "tests/unit/test.h"

namespace {

std::vector<double> noise(unsigned seed, std::size_t n) {
  ifog::test::Noise normal(seed);
  std::vector<double> out(n);
  for (double& v : out) v = normal();
  return out;
}

constexpr double kPeriod = 0.01;

std::vector<double> times(std::size_t n) {
  std::vector<double> out(n);
  for (std::size_t k = 0; k < n; ++k) out[k] = static_cast<double>(k) * kPeriod;
  return out;
}

ifog::ComparisonInput input_of(const std::vector<double>& rate, const std::vector<double>& time) {
  ifog::ComparisonInput out;
  out.time_s = time;
  out.rate = {rate};
  out.period_s = kPeriod;
  return out;
}

TEST(CompareFigures, LagOfADelayedSineIsTheDelay) {
  constexpr double kDelay = 0.0537;
  std::vector<double> reference, output;
  for (int k = 0; k < 6000; ++k) {
    reference.push_back(std::sin(2 * std::numbers::pi * 0.5 * k * kPeriod));
    output.push_back(0.02 + std::sin(2 * std::numbers::pi * 0.5 * (k * kPeriod - kDelay)));
  }
  const auto against = ifog::against_reference(output, reference, kPeriod, 90);
  ASSERT_TRUE(against.lag_s.has_value());
  EXPECT_NEAR(*against.lag_s, kDelay, 1e-4);
  EXPECT_NEAR(against.bias.value(), 0.02, 1e-4);
}

// A turntable's programme comes again; an error that drifts makes the output fit its last round a little
// better.
TEST(CompareFigures, OfAProgrammeThatRepeatsTheLagIsTheOneNearestToNone) {
  constexpr int kRound = 120, kDelay = 3;
  const auto programme = [](int k) { return (k / 10 * 7 % 12) * 0.1; };
  std::vector<double> reference, output;
  for (int k = 0; k < 1200; ++k) {
    reference.push_back(programme(k % kRound) * (1.0 - 1e-4 * k));
    output.push_back(k < kDelay ? 0.0
                                : programme((k - kDelay) % kRound) * (1.0 - 1e-4 * (k - kDelay - kRound)));
  }
  const auto against = ifog::against_reference(output, reference, 0.5, 250);
  ASSERT_TRUE(against.lag_s.has_value());
  EXPECT_NEAR(*against.lag_s, 0.5 * kDelay, 0.5 * 0.5);
}

TEST(CompareFigures, AReferenceAtRestTellsNoLag) {
  const auto output = noise(1, 4000);
  const std::vector<double> reference(output.size(), 0.0);
  EXPECT_FALSE(ifog::against_reference(output, reference, 0.01, 200).lag_s.has_value());
}

// For an AR(1) with coefficient a: rho_k = a^k, so the excess is n a²(1 − a⁴⁰)/(1 − a²)/20.
TEST(CompareFigures, WhitenessOfWhiteAndOfAutoregressiveNoise) {
  auto series = noise(2, 100000);
  const auto white = ifog::whiteness(series);
  EXPECT_NEAR(white.lag1, 0.0, 4.0 / std::sqrt(1e5));
  EXPECT_NEAR(white.excess, 1.0, 4.0 * std::sqrt(2.0 / 20.0));
  for (std::size_t k = 1; k < series.size(); ++k) series[k] += 0.5 * series[k - 1];
  const auto coloured = ifog::whiteness(series);
  EXPECT_NEAR(coloured.lag1, 0.5, 0.02);
  EXPECT_NEAR(coloured.excess, 1e5 * 0.25 / 0.75 / 20.0, 0.1 * 1e5 / 60.0);
}

TEST(CompareFigures, MissingSamplesCountNeitherForNorAgainst) {
  const double nan = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> with{1.0, nan, 3.0, 5.0}, without{1.0, 3.0, 5.0};
  EXPECT_DOUBLE_EQ(ifog::spread(with), ifog::spread(without));
  EXPECT_DOUBLE_EQ(ifog::spread(without), 2.0);
}

TEST(CompareFigures, AReferenceWithoutAValueTellsNothing) {
  const std::vector<double> missing(100, std::numeric_limits<double>::quiet_NaN());
  const auto against = ifog::against_reference(noise(3, 100), missing, 0.01, 20);
  EXPECT_FALSE(against.rmse || against.bias || against.lag_s);
}

TEST(CompareFigures, TheMedianIsUnknownWhenMostDidNotArrive) {
  EXPECT_EQ(ifog::median_reached({3.0, std::nullopt, 1.0}), 3.0);
  EXPECT_FALSE(ifog::median_reached({std::nullopt, std::nullopt, 1.0}).has_value());
}

// A conventional filter in its steady state answers a step as 1 − (1 − K)^k, K from the algebraic Riccati
// equation.
TEST(Compare, TheConventionalFilterTakesAsLongAsItsClosedFormGainSays) {
  constexpr double kR = 1e-12, kRatio = 1e-3;
  const std::size_t n = 20000;
  auto rate = noise(4, n);
  for (double& each : rate) each *= std::sqrt(kR);
  const std::vector<double> time = times(n);
  ifog::ComparisonOptions options;
  options.rules = {"ckf"};
  options.settings.process_noise = kRatio * kR / kPeriod;
  options.settings.measurement_noise = kR;
  options.settings.follow_manoeuvres = false;
  options.settings.conserve_angle = false;
  const auto result = ifog::compare_rules(input_of(rate, time), options);
  ASSERT_EQ(result.rows.size(), 2U);
  const auto& row = result.rows[1];
  const double p = 0.5 * (kRatio + std::sqrt(kRatio * kRatio + 4.0 * kRatio));  // predicted variance over R
  const double gain = p / (p + 1.0);
  const double expected = std::ceil(std::log(0.1) / std::log(1.0 - gain));
  ASSERT_TRUE(row.step[0].samples && row.step[1].samples);
  EXPECT_EQ(*row.step[0].samples, expected);
  EXPECT_EQ(*row.step[1].samples, expected);
  // Output of white noise through a first-order filter: variance K/(2 − K) R.
  EXPECT_NEAR(row.std_radps, std::sqrt(gain / (2.0 - gain) * kR), 0.05 * row.std_radps);
  // The filter is told a random walk that is not there: its innovations are a little smaller than it expects,
  // R (1 + K / (2 - K)) against R / (1 - K).
  const double nis = (1.0 + gain / (2.0 - gain)) * (1.0 - gain);
  ASSERT_TRUE(row.nis_mean && row.nis_typical);
  EXPECT_NEAR(*row.nis_mean, nis, 0.03);
  EXPECT_NEAR(*row.nis_typical, nis, 0.06);
  EXPECT_EQ(row.share_at_rest, 1.0);
  EXPECT_EQ(result.rows[0].rule, "raw");
}

// Two thirds of the record are turns of a thousand sigma; what the innovations say of the noise is said at
// rest.
TEST(Compare, InnovationsAreJudgedOutsideManoeuvres) {
  constexpr double kRatio = 1e-3;
  const std::size_t n = 60000;
  auto rate = noise(5, n);
  for (std::size_t k = 0; k < n; ++k)
    if (k % 3000 >= 1000) rate[k] += 1000.0 * std::sin(2 * std::numbers::pi * static_cast<double>(k) / 500.0);
  const std::vector<double> time = times(n);
  ifog::ComparisonOptions options;
  options.rules = {"ckf", "mmae"};
  options.settings.process_noise = kRatio / kPeriod;
  options.settings.measurement_noise = 1.0;
  const auto result = ifog::compare_rules(input_of(rate, time), options);
  for (const auto& row : result.rows) {
    if (row.rule == "raw") continue;
    EXPECT_LT(row.share_at_rest, 0.4) << row.rule;
    EXPECT_GT(row.share_at_rest, 0.2) << row.rule;
    ASSERT_TRUE(row.nis_typical && row.whiteness_lag1) << row.rule;
    EXPECT_NEAR(*row.nis_typical, 1.0, 0.15) << row.rule;
    EXPECT_NEAR(*row.whiteness_lag1, 0.0, 0.25) << row.rule;
  }
}

// A record of which the second third is a turn: its spread and its deviation are those of the two others.
TEST(Compare, WhatIsSaidAtRestIsOfTheRest) {
  const std::size_t n = 30000;
  auto rate = noise(6, n);
  const std::vector<double> time = times(n);
  ifog::ComparisonInput in = input_of(rate, time);
  in.at_rest = {{0, n / 3}, {2 * n / 3, n}};
  ifog::ComparisonOptions options;
  options.settings.process_noise = 1e-3 / kPeriod;
  options.settings.measurement_noise = 1.0;
  const auto still = ifog::compare_rules(in, options);
  for (std::size_t k = n / 3; k < 2 * n / 3; ++k) rate[k] += 500.0;
  in.rate = {rate};
  const auto turned = ifog::compare_rules(in, options);
  EXPECT_EQ(turned.rows[0].std_radps, still.rows[0].std_radps);
  EXPECT_EQ(turned.rows[0].adev_radps, still.rows[0].adev_radps);
  // White noise of one unit.
  EXPECT_NEAR(turned.rows[0].std_radps, 1.0, 0.03);
  EXPECT_NEAR(*turned.rows[0].adev_radps[1], 0.1, 0.01);
}

}  // namespace
