// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/periodogram.h"

#include <gtest/gtest.h>

#include <cmath>
#include <complex>
#include <limits>
#include <numbers>
#include <random>

namespace {

using ifog::Periodogram;
using ifog::periodogram;

std::vector<double> noise(std::size_t n) {
  std::mt19937_64 draw(7);
  std::normal_distribution<double> normal(3.0, 1.0);
  std::vector<double> values(n);
  for (double& value : values) value = normal(draw);
  return values;
}

// By definition.
double power_of(const std::vector<double>& values, std::size_t length, std::size_t bin) {
  double mean = 0.0;
  for (const double value : values) mean += value / static_cast<double>(values.size());
  std::complex<double> sum = 0.0;
  for (std::size_t i = 0; i < length; ++i)
    sum +=
        (values[i] - mean) * std::polar(1.0, -2.0 * std::numbers::pi * static_cast<double>(bin * i % length) /
                                                 static_cast<double>(length));
  return std::norm(sum);
}

TEST(Periodogram, OfManyShortTransformsIsThatOfOne) {
  // Squares, primes' powers, one row, in files.
  for (const std::size_t n : {32UL, 54UL, 1250UL, 2UL * 256 * 256, 162000UL, 160001UL, 3000000UL}) {
    const std::vector<double> values = noise(n);
    const Periodogram one = periodogram(values, n);
    const Periodogram many = periodogram(values, 16);
    ASSERT_EQ(many.length % 2, 0U);
    ASSERT_EQ(many.power.size(), many.length / 2 + 1);
    for (const std::size_t bin : {std::size_t{1}, std::size_t{5}, many.length / 3, many.length / 2})
      EXPECT_NEAR(many.power[bin], power_of(values, many.length, bin), 1e-9 * static_cast<double>(n)) << n;
    if (one.length != many.length) continue;
    double worst = 0.0;
    for (std::size_t k = 0; k < one.power.size(); ++k)
      worst = std::max(worst, std::abs(one.power[k] - many.power[k]));
    EXPECT_LT(worst, 1e-12 * static_cast<double>(n) * std::log2(static_cast<double>(n))) << n;
  }
}

TEST(Periodogram, ASineHasItsPowerInItsBin) {
  constexpr std::size_t kLength = 27000, kBin = 1234;
  std::vector<double> values(kLength);
  for (std::size_t i = 0; i < kLength; ++i)
    values[i] = 0.5 * std::sin(2.0 * std::numbers::pi * static_cast<double>(kBin * i % kLength) / kLength);
  const Periodogram found = periodogram(values, 16);
  EXPECT_EQ(found.length, kLength);
  EXPECT_NEAR(found.power[kBin] / (0.0625 * kLength * kLength), 1.0, 1e-12);
  EXPECT_LT(found.power[kBin + 1], 1e-12);
}

TEST(Periodogram, WhatIsMissingCountsAsTheMean) {
  std::vector<double> values = noise(6000);
  values[100] = std::numeric_limits<double>::quiet_NaN();
  double mean = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) mean += value / 5999.0;
  std::vector<double> filled = values;
  filled[100] = mean;
  const Periodogram holed = periodogram(values, 16), whole = periodogram(filled, 16);
  for (std::size_t k = 1; k < whole.power.size(); ++k) ASSERT_NEAR(holed.power[k], whole.power[k], 1e-6) << k;
}

}  // namespace
