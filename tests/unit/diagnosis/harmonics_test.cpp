// SPDX-License-Identifier: Apache-2.0
// Damped harmonics in the noise: the filter against dense covariances, the fit against what was drawn, and
// effects found beside a structure that sways.
#include "filters/diagnosis/regression/harmonics.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <numbers>

#include "filters/diagnosis/diagnose.h"
#include "filters/diagnosis/regression/design.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"

namespace ifog {
namespace {

constexpr double kTurn = 2.0 * std::numbers::pi;

NoiseShape swaying(const std::vector<DampedHarmonic>& harmonics, double walk = 0.0) {
  NoiseShape shape;
  shape.walk = walk;
  shape.harmonics = harmonics;
  return shape;
}

// Of what a block sees, from the covariance of what swings.
double covariance_at(const DampedHarmonic& h, double distance) {
  const auto of_itself = [&](double d) {
    return h.variance * std::exp(-std::abs(d) / h.decay) * std::cos(kTurn * h.cycles * d);
  };
  return (1.0 + h.returned * h.returned) * of_itself(distance) -
         h.returned * (of_itself(distance + 1.0) + of_itself(distance - 1.0));
}

Eigen::MatrixXd dense_covariance(const NoiseShape& shape, Eigen::Index n) {
  Eigen::MatrixXd v = Eigen::MatrixXd::Identity(n, n);
  for (Eigen::Index i = 0; i < n; ++i)
    for (Eigen::Index j = 0; j < n; ++j)
      for (const DampedHarmonic& h : shape.harmonics) v(i, j) += covariance_at(h, static_cast<double>(i - j));
  return v;
}

// Two angles, a rate, and what lies on either side of it.
const NoiseShape kSome = swaying({{40.0, 0.3, 4.0},
                                  {6.0, 0.11, 30.0},
                                  {9.0, 0.2, 12.0, 0.0},
                                  {5.0, 0.4, 7.0, 0.6},
                                  {3.0, 0.06, 20.0, -0.4}});

// What the last value of n is not told by those before it: the last pivot of the Cholesky factor.
TEST(Harmonics, InnovationVarianceIsTheLastPivotOfTheCovariance) {
  const Eigen::Index n = 400;
  const Eigen::MatrixXd factor = dense_covariance(kSome, n).llt().matrixL();
  const Whitening filter(grid_of({64}), kSome);
  EXPECT_NEAR(filter.innovation_variance(), std::pow(factor(n - 1, n - 1), 2), 1e-6);
}

TEST(Harmonics, LeastSquaresOfInnovationsIsGeneralisedLeastSquares) {
  constexpr Eigen::Index n = 900;
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const Eigen::MatrixXd v = dense_covariance(kSome, n);
  Columns columns(n, 3);
  Eigen::VectorXd drawn(n);
  for (double& value : drawn) value = normal(random);
  columns.col(0) = Eigen::MatrixXd(v.llt().matrixL()) * drawn;
  for (Eigen::Index i = 0; i < n; ++i) {
    columns(i, 1) = 1.0;
    columns(i, 2) = std::sin(0.02 * static_cast<double>(i));
  }
  const Eigen::LLT<Eigen::MatrixXd> factor(v);
  const Eigen::MatrixXd x = columns.rightCols(2);
  const Eigen::MatrixXd normals = x.transpose() * factor.solve(x);
  const Eigen::VectorXd expected =
      normals.ldlt().solve(x.transpose() * factor.solve(Eigen::VectorXd(columns.col(0))));
  Columns white = columns;
  Whitening(grid_of({n}), kSome).apply(white);
  const Eigen::VectorXd found =
      Eigen::MatrixXd(white.rightCols(2)).colPivHouseholderQr().solve(Eigen::VectorXd(white.col(0)));
  // The steady filter begins as if the first angles were known: that is worth a small part of the error bar.
  const double error_bar = std::sqrt(normals.inverse()(1, 1));
  EXPECT_NEAR(found[1], expected[1], 0.1 * error_bar);
}

TEST(Harmonics, DensityIsTheSumOfTheCovariancesWithTheirPhases) {
  const BlockGrid grid = grid_of({1000});
  for (const double cycles : {0.0, 0.01, 0.11, 0.25, 0.3, 0.5}) {
    double sum = 1.0;
    for (int d = -600; d <= 600; ++d)
      for (const DampedHarmonic& h : kSome.harmonics)
        sum += covariance_at(h, d) * std::cos(kTurn * cycles * static_cast<double>(d));
    EXPECT_NEAR(relative_density(grid, kSome, cycles), sum, 1e-6 * (1.0 + sum)) << cycles;
  }
}

// Of many blocks the mean scatters by the density at zero.
TEST(Harmonics, WhatIsWhiteAtSlowFrequenciesIsTheVarianceOfALongMean) {
  double sum = 1.0;
  for (int d = -600; d <= 600; ++d)
    for (const DampedHarmonic& h : kSome.harmonics) sum += covariance_at(h, d);
  EXPECT_NEAR(slow_white(kSome), sum, 1e-6 * sum);
  EXPECT_GT(sum, 3.0);
  NoiseShape angles = swaying({kSome.harmonics[0], kSome.harmonics[1]});
  EXPECT_NEAR(slow_white(angles), 1.0, 1e-12);
  EXPECT_NEAR(*noise_terms(kSome, 4.0, 0.25).N, std::sqrt(sum), 1e-6 * std::sqrt(sum));
}

// Rate of a structure whose angle is a damped oscillator's, as means over steps.
class Tower {
 public:
  Tower(double frequency_hz, double quality, double angle, std::uint64_t seed)
      : random_(seed), angle_(angle), frequency_hz_(frequency_hz), quality_(quality) {
    state_ = angle_ * deviate();
  }
  double turned_in(double dt) {
    const double before = state_.real();
    return (swung_to(dt) - before) / dt;
  }
  // As a rate where that is what swings.
  double swung_to(double dt) {
    const double left = std::exp(-dt * std::numbers::pi * frequency_hz_ / quality_);
    state_ = state_ * std::polar(left, kTurn * frequency_hz_ * dt) +
             angle_ * std::sqrt(1.0 - left * left) * deviate();
    return state_.real();
  }

 private:
  // The order of two draws in one expression is the compiler's, and another one's on aarch64.
  std::complex<double> deviate() {
    const double imaginary = normal_(random_), real = normal_(random_);
    return {real, imaginary};
  }

  std::mt19937_64 random_;
  std::normal_distribution<double> normal_;
  double angle_, frequency_hz_, quality_;
  std::complex<double> state_;
};

Columns with_constant(const std::vector<double>& values) {
  Columns columns(static_cast<Eigen::Index>(values.size()), 2);
  columns.col(1).setOnes();
  columns.col(0) = Eigen::Map<const Eigen::VectorXd>(values.data(), columns.rows());
  return columns;
}

// At 0.54 Hz seen through blocks of 2 s it stands at 0.08 cycles a block and keeps its phase for Q / (pi f).
TEST(Harmonics, TheFitFindsTheTowerAtItsAliasAndTheFloorBesideIt) {
  const std::size_t n = 3500;
  for (const std::uint64_t seed : {1U, 2U, 3U}) {
    Tower tower(0.54, 30.0, 10.0, seed);
    std::mt19937_64 random(100 + seed);
    std::normal_distribution<double> normal;
    std::vector<double> values;
    for (std::size_t i = 0; i < n; ++i) values.push_back(tower.turned_in(2.0) + normal(random));
    BlockGrid grid = grid_of({n});
    const NoiseFit fit = fit_noise(grid, with_constant(values));
    ASSERT_EQ(fit.shape.harmonics.size(), 1U) << seed;
    const DampedHarmonic& found = fit.shape.harmonics[0];
    EXPECT_NEAR(found.cycles, 0.08, 0.004) << seed;
    EXPECT_NEAR(found.decay, 30.0 / (std::numbers::pi * 0.54) / 2.0, 0.25 * 8.8) << seed;
    EXPECT_NEAR(std::sqrt(fit.white_variance), 1.0, 0.1) << seed;
  }
}

// Means over so many samples of a rate that swings, whose floor at slow frequencies is far above the white
// noise. Every effect is judged in that floor: its density by the sum of the covariances, below a tenth of
// the resonance.
TEST(Harmonics, ARateThatSwingsLeavesItsFloorAtSlowFrequencies) {
  constexpr std::size_t kBlocks = 4000;
  constexpr double kHz = 0.3, kQuality = 40.0, kStep = 0.2, kRate = 40.0;
  for (const std::size_t samples : {1U, 5U, 9U}) {
    const double decay = kQuality / (std::numbers::pi * kHz * kStep);  // samples
    const auto of_samples = [&](double d) {
      return kRate * kRate * std::exp(-std::abs(d) / decay) * std::cos(kTurn * kHz * kStep * d);
    };
    double expected = 1.0;
    for (int d = -20000; d <= 20000; ++d) expected += of_samples(d);
    std::vector<double> ratios;
    for (const std::uint64_t seed : {1U, 2U, 3U, 4U, 5U}) {
      Tower tower(kHz, kQuality, kRate, seed);
      std::mt19937_64 random(300 + seed);
      std::normal_distribution<double> normal;
      std::vector<double> values(kBlocks, 0.0);
      for (double& value : values)
        for (std::size_t i = 0; i < samples; ++i)
          value += (tower.swung_to(kStep) + normal(random)) / std::sqrt(static_cast<double>(samples));
      const BlockGrid grid = grid_of({kBlocks});
      const NoiseFit fit = fit_noise(grid, with_constant(values));
      ASSERT_FALSE(fit.shape.harmonics.empty()) << seed;
      for (const double cycles : {0.001, 0.003, 0.005})
        ratios.push_back(fit.white_variance * relative_density(grid, fit.shape, cycles) / expected);
    }
    for (const double ratio : ratios) EXPECT_NEAR(std::log(ratio), 0.0, 0.5) << samples << " samples a block";
  }
}

TEST(Harmonics, NoneInWhiteNoiseAndNoneInAWalk) {
  for (std::uint64_t seed = 0; seed < 12; ++seed) {
    std::mt19937_64 random(200 + seed);
    std::normal_distribution<double> normal;
    std::vector<double> values;
    double walk = 0.0;
    for (std::size_t i = 0; i < 2000; ++i) {
      if (seed % 2 == 1) walk += 0.05 * normal(random);
      values.push_back(normal(random) + walk);
    }
    EXPECT_TRUE(fit_noise(grid_of({2000}), with_constant(values)).shape.harmonics.empty()) << seed;
  }
}

struct Capture {
  std::vector<double> time_s, rate, temperature;

  [[nodiscard]] Record record() const {
    Record record;
    record.name = "capture";
    record.time_s = time_s;
    record.rate_radps = rate;
    record.channels = {{"temperature_degC", temperature}};
    return record;
  }
  [[nodiscard]] Diagnosis diagnosed() const { return diagnose({record()}, {}); }
};

constexpr double kWhite = 1e-6;  // rad/s, of a sample
constexpr double kSample_s = 0.2;

Capture on_a_tower(std::uint64_t seed, double angle) {
  Capture capture;
  Tower tower(0.54, 30.0, angle, seed);
  std::mt19937_64 random(300 + seed);
  std::normal_distribution<double> normal;
  for (std::size_t i = 0; i < 36000; ++i) {
    const double t = kSample_s * static_cast<double>(i);
    capture.time_s.push_back(t);
    capture.rate.push_back(tower.turned_in(kSample_s) + kWhite * normal(random));
    capture.temperature.push_back(28.0 + 6.0 * std::sin(kTurn * t / 3100.0) +
                                  2.0 * std::sin(kTurn * t / 700.0 + 1.0));
  }
  return capture;
}

// The derivative at so many times the error that white noise alone would leave of it.
void add_rate_effect(Capture& capture, double floors) {
  const std::size_t n = capture.rate.size();
  std::vector<double> slope(n, 0.0);
  double square = 0.0;
  for (std::size_t i = 1; i < n; ++i) {
    slope[i] = (capture.temperature[i] - capture.temperature[i - 1]) / kSample_s;
    square += slope[i] * slope[i];
  }
  for (std::size_t i = 0; i < n; ++i) capture.rate[i] += floors * kWhite / std::sqrt(square) * slope[i];
}

// The angle is such that the rate it makes is some thirty times the white noise of means of a second.
constexpr double kSway = 30.0 * kWhite * 0.447 / (kTurn * 0.54);

TEST(Diagnose, FindsARateOfTheTemperatureOnATowerThatSways) {
  for (const std::uint64_t seed : {11U, 12U, 13U}) {
    Capture capture = on_a_tower(seed, kSway);
    EXPECT_TRUE(capture.diagnosed().effects.empty()) << seed;
    add_rate_effect(capture, 14.0);
    const Diagnosis found = capture.diagnosed();
    ASSERT_EQ(found.effects.size(), 1U) << seed;
    EXPECT_EQ(found.effects[0].effect.form, "rate") << seed;
    EXPECT_EQ(found.effects[0].effect.channel, "temperature_degC") << seed;
  }
}

// A thermostat's cycle is as narrow as a resonance. What the channel explains is the channel's.
TEST(Diagnose, AThermostatsCycleIsNotTakenForAResonance) {
  Capture capture = on_a_tower(21, 0.0);
  Tower thermostat(1.0 / 60.0, 12.0, 1.0, 22);
  double cycle = 0.0;
  for (std::size_t i = 0; i < capture.rate.size(); ++i) {
    cycle += 0.05 * thermostat.turned_in(kSample_s) * kSample_s;
    capture.temperature[i] = 28.0 + cycle;
    capture.rate[i] += 10.0 * kWhite * cycle;
  }
  const Diagnosis found = capture.diagnosed();
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].effect.form, "linear");
  EXPECT_NEAR(found.effects[0].effect.parameters[0].value, 10.0 * kWhite, 1.5 * kWhite);
}

}  // namespace
}  // namespace ifog
