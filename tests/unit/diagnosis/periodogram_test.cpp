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
