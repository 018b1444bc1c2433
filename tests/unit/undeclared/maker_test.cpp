// SPDX-License-Identifier: Apache-2.0
// The maker and its oracle measure the diagnosis, so they are themselves measured: against dense linear
// algebra, the closed form of the spectrum, and an estimator that is given the truth.
#include <gtest/gtest.h>

#include <Eigen/Dense>
#include <cmath>
#include <numbers>

#include "tests/bench/undeclared/oracle_diagnosis.h"
#include "tests/bench/undeclared/tally.h"

namespace {

using namespace ifog::undeclared;

double density_of_flicker(const NoiseTruth& truth, double f_hz) {
  return truth.B * truth.B / (2.0 * std::numbers::pi * f_hz);
}

// One-sided density at f by averaging |DFT|^2 over many draws.
TEST(UndeclaredNoise, FlickerHasTheDensityOfIeee952) {
  const NoiseTruth truth{0.0, 1.0, 0.0};
  const std::size_t n = 2048;
  const NoiseModel model({1e-6, 1.0, 0.0}, n, 1.0);
  Draw draw(7, 0);
  const int records = 400;
  for (const std::size_t line : {8U, 16U, 32U}) {
    Draw same = draw;
    double power = 0.0;
    for (int r = 0; r < records; ++r) {
      const std::vector<double> x = model.draw(same);
      double re = 0.0, im = 0.0;
      for (std::size_t k = 0; k < n; ++k) {
        const double turn = 2.0 * std::numbers::pi * static_cast<double>(line * k) / static_cast<double>(n);
        const double window = 0.5 - 0.5 * std::cos(2.0 * std::numbers::pi * static_cast<double>(k) / n);
        re += window * x[k] * std::cos(turn);
        im += window * x[k] * std::sin(turn);
      }
      power += (re * re + im * im) * 2.0 / (0.375 * static_cast<double>(n)) / records;
    }
    const double expected = density_of_flicker(truth, static_cast<double>(line) / static_cast<double>(n));
    EXPECT_NEAR(power / expected, 1.0, 4.0 / std::sqrt(records)) << "line " << line;
  }
}

// GLS by the dense covariance of white noise and a random walk: V = w^2 I + q^2 min(i, j).
TEST(UndeclaredNoise, VisibilityIsThatOfDenseLeastSquares) {
  const Eigen::Index n = 300;
  const double dt = 0.5, N = 2.0, K = 0.3;
  Eigen::MatrixXd V(n, n);
  Eigen::MatrixXd A(n, 3);
  Visibility::Column linear(1), wave(1);
  for (Eigen::Index i = 0; i < n; ++i) {
    for (Eigen::Index j = 0; j < n; ++j)
      V(i, j) = K * K * dt * static_cast<double>(std::min(i, j)) + (i == j ? N * N / dt : 0.0);
    const double x = static_cast<double>(i) / static_cast<double>(n);
    A(i, 0) = x * x;
    A(i, 1) = std::sin(9.0 * x);
    A(i, 2) = 1.0;
    linear[0].push_back(A(i, 0));
    wave[0].push_back(A(i, 1));
  }
  const Eigen::MatrixXd covariance = (A.transpose() * V.ldlt().solve(A)).inverse();
  const auto model =
      std::make_shared<const NoiseModel>(NoiseTruth{N, 0.0, K}, static_cast<std::size_t>(n), dt);
  const Visibility oracle(model, 1);
  EXPECT_NEAR(oracle.of(linear, {wave}) * std::sqrt(covariance(0, 0)), 1.0, 1e-6);
  EXPECT_NEAR(oracle.of(wave, {linear}) * std::sqrt(covariance(1, 1)), 1.0, 1e-6);
}

TEST(UndeclaredScore, AnEstimatorThatIsToldTheTruthIsScoredRightAndItsIntervalsHold) {
  std::vector<Score> scores;
  std::uint64_t seed = 100;
  for (int round = 0; round < 2; ++round)
    for (const Kind kind : kinds_with_effect()) {
      const Sensor sensor = draw_sensor(seed++, kind, 25.0);
      scores.push_back(score(sensor, oracle_diagnosis(sensor)));
    }
  const Totals t = total(scores);
  EXPECT_EQ(t.right, t.sensors);
  EXPECT_EQ(t.extra, 0);
  EXPECT_EQ(t.made_worse, 0);
  EXPECT_LE(t.error_median, 0.06);
  EXPECT_LE(t.error_p90, 0.2);
  // 28 intervals at 95 %: fewer than 23 inside happens less than once in 1000.
  EXPECT_GE(t.coverage * t.intervals, 23.0) << t.intervals;
}

TEST(UndeclaredScore, FindingNothingMissesEverythingAndRaisesNoAlarm) {
  std::vector<Score> scores;
  for (const Kind kind :
       {Kind::kTemperatureLinear, Kind::kLine, Kind::kTwo, Kind::kUncovered, Kind::kNothing})
    scores.push_back(score(draw_sensor(5, kind, 25.0), blind_diagnosis()));
  const Totals t = total(scores);
  EXPECT_EQ(t.missed, 3);
  EXPECT_EQ(t.uncovered_said, 0);
  EXPECT_EQ(t.false_alarms, 0);
}

Finding claim(const std::string& form, const std::string& channel,
              std::function<std::vector<double>(const ifog::Capture&)> waveform) {
  Finding f;
  f.effects.resize(1);
  f.effects[0].effect.form = form;
  f.effects[0].effect.channel = channel;
  f.effects[0].waveform = std::move(waveform);
  return f;
}

TEST(UndeclaredScore, AnotherNameIsRightOnlyWhenNobodyCouldTell) {
  const Sensor sensor = draw_sensor(5, Kind::kSupply, 40.0);
  const auto supply = [&](const ifog::Capture& c) { return c.channels[4].values; };
  const auto humidity = [&](const ifog::Capture& c) { return c.channels[7].values; };
  const auto under = [&](const Finding& f) {
    return score(sensor, [&](const std::vector<ifog::Capture>&) { return f; });
  };
  const Score named = under(claim("linear", "supply_V", supply));
  EXPECT_EQ(named.exact, 1);
  const Score renamed = under(claim("lagged", "supply_V", supply));
  EXPECT_EQ(renamed.exact, 0);
  EXPECT_EQ(renamed.equivalent, 1);
  EXPECT_EQ(renamed.extra, 0);
  const Score wrong = under(claim("linear", "humidity_percent", humidity));
  EXPECT_EQ(wrong.missed, 1);
  EXPECT_EQ(wrong.extra, 1);
}

}  // namespace
