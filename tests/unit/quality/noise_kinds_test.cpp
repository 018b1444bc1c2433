// SPDX-License-Identifier: Apache-2.0
// The noise of the regimes against the closed forms of its distribution, its moments and its correlation.
// Every tolerance is five standard errors of what is compared.
#include "tests/bench/quality/noise_kinds.h"

#include <gtest/gtest.h>

#include <cmath>
#include <functional>
#include <numbers>

namespace {

using ifog::bench::Random;

constexpr std::size_t kSamples = 400'000;

double normal_cdf(double x) { return 0.5 * std::erfc(-x / std::numbers::sqrt2); }

void expect_distribution(const std::vector<double>& values, const std::vector<double>& at,
                         const std::function<double(double)>& cdf) {
  const auto n = static_cast<double>(values.size());
  for (const double x : at) {
    double below = 0.0;
    for (const double v : values) below += v <= x ? 1.0 : 0.0;
    const double p = cdf(x);
    EXPECT_NEAR(below / n, p, 5.0 * std::sqrt(p * (1.0 - p) / n)) << "at " << x;
  }
}

// E value^power at mean 0; its standard error needs the moment of twice the order.
void expect_moment(const std::vector<double>& values, int power, double moment, double moment_of_twice) {
  double sum = 0.0;
  for (const double v : values) sum += std::pow(v, power);
  const auto n = static_cast<double>(values.size());
  EXPECT_NEAR(sum / n, moment, 5.0 * std::sqrt((moment_of_twice - moment * moment) / n)) << "power " << power;
}

// Neighbours of white noise of variance one: E ab = 0, var ab = 1.
void expect_white(const std::vector<double>& values) {
  for (const std::size_t lag : {1U, 2U, 17U}) {
    double sum = 0.0;
    for (std::size_t i = lag; i < values.size(); ++i) sum += values[i] * values[i - lag];
    const auto n = static_cast<double>(values.size() - lag);
    EXPECT_NEAR(sum / n, 0.0, 5.0 / std::sqrt(n)) << "lag " << lag;
  }
}

TEST(NoiseKinds, Gaussian) {
  Random random(1);
  const auto values = ifog::bench::gaussian_noise(random, kSamples).value;
  expect_distribution(values, {-2.0, -1.0, 0.0, 1.0, 2.0}, normal_cdf);
  expect_moment(values, 2, 1.0, 3.0);
  expect_white(values);
}

// t with three degrees over √3 has the distribution 1/2 + (u/(1 + u²) + atan u)/π.
TEST(NoiseKinds, StudentOfThreeDegrees) {
  Random random(2);
  const auto values = ifog::bench::student_noise(random, kSamples).value;
  expect_distribution(values, {-6.0, -2.0, -0.5, 0.0, 0.5, 2.0, 6.0},
                      [](double u) { return 0.5 + (u / (1.0 + u * u) + std::atan(u)) / std::numbers::pi; });
  expect_white(values);
}

// Central moments of the exponential distribution: 1, 2, 9, …, 265 of the sixth order.
TEST(NoiseKinds, Skewed) {
  Random random(3);
  const auto values = ifog::bench::skewed_noise(random, kSamples).value;
  expect_distribution(values, {-0.9, -0.5, 0.0, 1.0, 3.0}, [](double v) { return 1.0 - std::exp(-v - 1.0); });
  expect_moment(values, 1, 0.0, 1.0);
  expect_moment(values, 2, 1.0, 9.0);
  expect_moment(values, 3, 2.0, 265.0);
  expect_white(values);
}

TEST(NoiseKinds, Bimodal) {
  Random random(4);
  const auto values = ifog::bench::bimodal_noise(random, kSamples).value;
  const double width = std::sqrt(1.0 - 0.81);
  expect_distribution(values, {-1.5, -0.9, -0.3, 0.0, 0.9, 1.5}, [width](double x) {
    return 0.5 * (normal_cdf((x - 0.9) / width) + normal_cdf((x + 0.9) / width));
  });
  expect_moment(values, 1, 0.0, 1.0);
  expect_moment(values, 2, 1.0, 3.0 - 2.0 * std::pow(0.9, 4));
  expect_white(values);
}

// Bartlett: n var r_k = Σ over all m of ρ_m² + ρ_{m+k} ρ_{m−k}, at most twice (1 + ρ²)/(1 − ρ²).
TEST(NoiseKinds, CorrelationOfColour) {
  for (const double correlation : {0.5, 0.9, 0.98}) {
    Random random(8);
    const auto values = ifog::bench::coloured_noise(random, kSamples, correlation).value;
    const double square = correlation * correlation;
    for (const int lag : {0, 1, 2, 10, 50}) {
      double sum = 0.0;
      const auto k = static_cast<std::size_t>(lag);
      for (std::size_t i = k; i < kSamples; ++i) sum += values[i] * values[i - k];
      const auto n = static_cast<double>(kSamples - k);
      EXPECT_NEAR(sum / n, std::pow(correlation, lag),
                  5.0 * std::sqrt(2.0 * (1.0 + square) / (1.0 - square) / n))
          << correlation << ", lag " << lag;
    }
  }
}

}  // namespace
