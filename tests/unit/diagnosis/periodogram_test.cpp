// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/residual/periodogram.h"

#include <gtest/gtest.h>

#include <cmath>
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

// A tone between two of a piece's bins adds up over all pieces by its own frequency; of noise each bin is the
// mean of them.
TEST(Periodogram, OfALongSeriesIsTheMeanOfItsPieces) {
  constexpr std::size_t kLength = 27000, kBin = 1234;
  std::vector<double> values(4 * kLength);
  for (std::size_t i = 0; i < values.size(); ++i)
    values[i] = 0.5 * std::sin(2.0 * std::numbers::pi * static_cast<double>(kBin * i % kLength) / kLength);
  const Periodogram found = periodogram(values, kLength);
  EXPECT_EQ(found.pieces, 4U);
  EXPECT_EQ(found.length, kLength);
  EXPECT_NEAR(found.power[kBin] / (0.0625 * kLength * kLength), 1.0, 1e-12);
  EXPECT_LT(found.power[kBin + 1], 1e-12);
  const Periodogram white = periodogram(noise(100000), 1000);
  double square = 0.0;
  for (std::size_t k = 1; k + 1 < white.power.size(); ++k)
    square += std::pow(white.power[k] / 1000.0 - 1.0, 2);
  // Means of a hundred exponential variates.
  EXPECT_NEAR(square / 499.0, 0.01, 0.004);
}

TEST(Periodogram, WhatIsMissingCountsAsTheMean) {
  std::vector<double> values = noise(6000);
  values[100] = std::numeric_limits<double>::quiet_NaN();
  double mean = 0.0;
  for (const double value : values)
    if (std::isfinite(value)) mean += value / 5999.0;
  std::vector<double> filled = values;
  filled[100] = mean;
  const Periodogram holed = periodogram(values), whole = periodogram(filled);
  for (std::size_t k = 1; k < whole.power.size(); ++k) ASSERT_NEAR(holed.power[k], whole.power[k], 1e-6) << k;
}

}  // namespace
