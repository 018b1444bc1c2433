// SPDX-License-Identifier: Apache-2.0
// Each noise term against the closed form of its Allan variance (IEEE Std 952), with the variance estimated
// here by the definition, not by our own Allan code.
#include "tools/simulate/noise.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

namespace {

using ifog::simulate::NoiseLevels;

// Mean of (ȳ₂ − ȳ₁)²/2 over non-overlapping pairs of m samples.
double allan_variance(const std::vector<double>& rate, std::size_t m) {
  double sum = 0.0;
  std::size_t pairs = 0;
  for (std::size_t i = 0; i + 2 * m <= rate.size(); i += 2 * m, ++pairs) {
    double a = 0.0, b = 0.0;
    for (std::size_t k = 0; k < m; ++k) {
      a += rate[i + k];
      b += rate[i + m + k];
    }
    const double d = (b - a) / static_cast<double>(m);
    sum += 0.5 * d * d;
  }
  return sum / static_cast<double>(pairs);
}

// Mean over records of the ratio to the closed form at each m, with its standard error from the scatter.
void expect_form(const NoiseLevels& levels, double rate_hz, double (*form)(const NoiseLevels&, double)) {
  constexpr std::size_t kSamples = 1U << 15U;
  constexpr int kRecords = 40;
  for (const std::size_t m : {1U, 2U, 8U, 64U, 512U, 4096U}) {
    double sum = 0.0, square = 0.0;
    for (int record = 0; record < kRecords; ++record) {
      const auto rate =
          ifog::simulate::noise(levels, rate_hz, kSamples, 100 + static_cast<std::uint64_t>(record));
      const double ratio = allan_variance(rate, m) / form(levels, static_cast<double>(m) / rate_hz);
      sum += ratio;
      square += ratio * ratio;
    }
    const double mean = sum / kRecords;
    const double error = std::sqrt((square / kRecords - mean * mean) / (kRecords - 1));
    EXPECT_LT(std::abs(mean - 1.0), 4.0 * error + 0.004)
        << "m = " << m << ", mean " << mean << " ± " << error;
  }
}

TEST(Noise, AngleRandomWalk) {
  expect_form({.N = 1e-6}, 200.0, [](const NoiseLevels& c, double tau) { return c.N * c.N / tau; });
}

TEST(Noise, BiasInstability) {
  expect_form({.B = 3e-8}, 200.0, [](const NoiseLevels& c, double) {
    return 2.0 * std::numbers::ln2 / std::numbers::pi * c.B * c.B;
  });
}

TEST(Noise, RateRandomWalk) {
  expect_form({.K = 1e-9}, 50.0, [](const NoiseLevels& c, double tau) { return c.K * c.K * tau / 3.0; });
}

TEST(Noise, QuantisationOfADitheredAngle) {
  // Angle noise of four steps a sample makes the rounding error uniform and independent.
  const double rate_hz = 100.0, q = 1e-7;
  expect_form(
      {.Q = q, .N = 4.0 * std::sqrt(12.0) * q * std::sqrt(rate_hz)}, rate_hz,
      [](const NoiseLevels& c, double tau) { return 3.0 * c.Q * c.Q / (tau * tau) + c.N * c.N / tau; });
}

TEST(Noise, QuantisedRateIsWholeStepsAndKeepsTheAngle) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1e-5}, 100.0, 10000, 3);
  double before = 0.0, after = 0.0;
  for (const double r : rate) before += r * 0.01;
  const double lsb = 4.8481368e-7;
  ifog::simulate::quantise_angle(rate, 0.01, lsb);
  for (const double r : rate) {
    after += r * 0.01;
    EXPECT_NEAR(std::remainder(r * 0.01 / lsb, 1.0), 0.0, 1e-9);
  }
  EXPECT_LE(std::abs(after - before), 0.5 * lsb * (1.0 + 1e-6));
}

TEST(Noise, RampIsTheMeanRateOfEachStep) {
  const auto rate = ifog::simulate::noise({.R = 2e-6}, 10.0, 100, 1);
  for (std::size_t i = 0; i < rate.size(); ++i)
    EXPECT_DOUBLE_EQ(rate[i], 2e-6 * 0.1 * (static_cast<double>(i) + 0.5));
}

TEST(Noise, GaussMarkovHasTheVarianceOfItsMeans) {
  // Var of the mean over h correlation times: 2(h − 1 + e⁻ʰ)/h², lag-1 covariance (1 − e⁻ʰ)²/h².
  for (const double h : {1e-4, 0.5, 3.0}) {
    double variance = 0.0, lag = 0.0;
    constexpr int kRuns = 400, kSteps = 500;
    for (int run = 0; run < kRuns; ++run) {
      ifog::simulate::GaussMarkov source(2.0, 1.0 / h, 1.0,
                                         ifog::simulate::Draw(9, static_cast<std::uint32_t>(run)));
      double before = source.next();
      for (int i = 0; i < kSteps; ++i) {
        const double x = source.next();
        variance += x * x;
        lag += x * before;
        before = x;
      }
    }
    constexpr double kAll = double{kRuns} * kSteps;
    const double expected = 2.0 * (h + std::expm1(-h)) / (h * h);
    const double independent = std::max(double{kRuns}, kAll * std::min(1.0, h / 2));
    EXPECT_NEAR(variance / kAll / 4.0, expected, 4.5 * std::sqrt(2.0 / independent) * expected) << h;
    EXPECT_NEAR(lag / kAll / 4.0, std::pow(std::expm1(-h) / h, 2),
                4.5 * std::sqrt(2.0 / independent) * expected)
        << h;
  }
}

TEST(Noise, RefusesImpossibleLevels) {
  EXPECT_THROW((void)ifog::simulate::noise({.N = -1.0}, 1.0, 1, 1), std::invalid_argument);
  EXPECT_THROW((void)ifog::simulate::noise({.K = std::nan("")}, 1.0, 1, 1), std::invalid_argument);
}

}  // namespace
