// SPDX-License-Identifier: Apache-2.0
// A warm-up is what no channel explains, and what the start of the filter does not make by itself.
#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <random>

#include "filters/diagnosis/checks/start_of_record.h"
#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

// Two hours at 1 Hz beside a thermometer; noise 1e-6 rad/s.
Diagnosis diagnosis_of(const std::function<double(double)>& temperature,
                       const std::function<double(double t, double celsius)>& error, std::uint64_t seed) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  std::vector<double> time, rate, celsius;
  for (int i = 0; i < 7200; ++i) {
    const double t = i;
    time.push_back(t);
    celsius.push_back(temperature(t) + 0.004 * normal(random));
    rate.push_back(error(t, temperature(t)) + 1e-6 * normal(random));
  }
  Record record;
  record.name = "two hours";
  record.time_s = time;
  record.rate_radps = rate;
  record.channels = {{"temperature_degC", celsius}};
  return diagnose({record}, {});
}

std::vector<std::string> named(const Diagnosis& diagnosis) {
  std::vector<std::string> names;
  for (const FoundEffect& found : diagnosis.effects)
    names.push_back(found.effect.form + (found.effect.channel.empty() ? "" : " of " + found.effect.channel));
  return names;
}

// A sensor that heats itself: a bias with a turning point at 31 °C settles much as a warm-up does.
TEST(WarmUp, WhatTheTemperatureExplainsIsTheTemperatures) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Diagnosis found =
        diagnosis_of([](double t) { return 38.0 - 14.0 * std::exp(-t / 1100.0) + 0.5 * std::sin(t / 400.0); },
                     [](double, double celsius) { return 2e-8 * std::pow(celsius - 31.0, 2); }, seed);
    ASSERT_FALSE(found.effects.empty()) << seed;
    for (const std::string& name : named(found))
      EXPECT_NE(name.find(" of temperature_degC"), std::string::npos) << seed << ' ' << name;
  }
}

// One that does not heat itself in a room of its own weather.
TEST(WarmUp, WhatNoChannelExplainsIsAWarmUp) {
  for (std::uint64_t seed = 1; seed <= 4; ++seed) {
    const Diagnosis found =
        diagnosis_of([](double t) { return 22.0 + 2.0 * std::sin(t / 900.0 + 1.0) + std::sin(t / 330.0); },
                     [](double t, double) { return 1e-6 * std::exp(-t / 500.0); }, seed);
    EXPECT_EQ(named(found), std::vector<std::string>{"warm_up"}) << seed;
  }
}

// Covariance of what a swaying structure, flicker and white noise make, written down block by block, and
// generalised least squares with its Cholesky factor: no filter.
Eigen::MatrixXd covariance_by_hand(const BlockGrid& grid, const NoiseShape& shape) {
  const auto n = static_cast<Eigen::Index>(grid.size());
  Eigen::MatrixXd covariance = Eigen::MatrixXd::Identity(n, n);
  const auto angle = [&](const DampedHarmonic& each, double distance) {
    return each.variance * std::exp(-std::abs(distance) / each.decay) *
           std::cos(2.0 * M_PI * each.cycles * distance);
  };
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j) {
      const auto apart = static_cast<double>(i - j);
      for (const double tau : flicker_bank(grid))
        covariance(i, j) += shape.flicker * std::exp(-std::abs(apart) / tau);
      for (const DampedHarmonic& each : shape.harmonics)
        covariance(i, j) += 2.0 * angle(each, apart) - angle(each, apart + 1.0) - angle(each, apart - 1.0);
    }
  return covariance;
}

double square_left_by_hand(const Eigen::LLT<Eigen::MatrixXd>& factor, const Eigen::MatrixXd& columns,
                           const Eigen::VectorXd& measured) {
  const Eigen::MatrixXd white = factor.matrixL().solve(columns);
  const Eigen::VectorXd y = factor.matrixL().solve(measured);
  return (y - white * white.colPivHouseholderQr().solve(y)).squaredNorm();
}

TEST(WarmUp, IsJudgedAsIfTheStartOfTheRecordWereNotKnown) {
  constexpr std::size_t kBlocks = 240;
  NoiseShape shape;
  shape.flicker = 0.8;
  shape.harmonics = {{30.0, 0.11, 40.0}};
  for (std::uint64_t seed = 1; seed <= 3; ++seed) {
    BlockData data = white_with_temperature(kBlocks, seed);
    const Eigen::LLT<Eigen::MatrixXd> factor(covariance_by_hand(data.grid, shape));
    Eigen::VectorXd warm_up(kBlocks);
    for (Eigen::Index i = 0; i < warm_up.size(); ++i) warm_up[i] = std::exp(-static_cast<double>(i) / 12.0);
    data.grid.error = factor.matrixL() * data.grid.error.eval() + static_cast<double>(seed) * warm_up;
    Candidate candidate;
    candidate.form = Form::kWarmUp;
    candidate.time_constant_s = 12.0;
    const double ratio = ratio_beside_the_start(data, {candidate}, 0, shape);
    Eigen::MatrixXd columns(kBlocks, 2);
    columns << Eigen::VectorXd::Ones(kBlocks), warm_up;
    const double expected = static_cast<double>(kBlocks) *
                            std::log(square_left_by_hand(factor, columns.leftCols(1), data.grid.error) /
                                     square_left_by_hand(factor, columns, data.grid.error));
    EXPECT_NEAR(ratio, expected, 1e-6 * std::max(1.0, expected)) << seed;
  }
}

}  // namespace
}  // namespace ifog
