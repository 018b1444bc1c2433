// SPDX-License-Identifier: Apache-2.0
// Rates at a coarser step against their definition, and their covariance against closed forms.
#include "filters/allan/noise/angle_means.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "tools/simulate/draw.h"

namespace {

using ifog::kB;
using ifog::kK;
using ifog::kN;
using ifog::kQ;

TEST(AngleMeans, AreDifferencesOfMeansOverTheStep) {
  ifog::simulate::Draw draw(3, 1);
  std::vector<double> angle(1000);
  for (double& a : angle) a = draw.normal();
  const ifog::AngleMeans means(angle, 0, angle.size());
  for (int level = 0; level <= 8; ++level) {
    const std::size_t step = std::size_t{1} << static_cast<unsigned>(level);
    ASSERT_EQ(means.rates(level), angle.size() / step - 1);
    std::vector<double> rate(means.rates(level) - 1);
    means.rates(level, 1, rate);
    for (std::size_t i = 0; i < rate.size(); ++i) {
      double wanted = 0.0;
      for (std::size_t k = 0; k < step; ++k) wanted += angle[(i + 2) * step + k] - angle[(i + 1) * step + k];
      const auto s = static_cast<double>(step);
      EXPECT_NEAR(rate[i], wanted / (s * s), 1e-13) << "level " << level;
    }
  }
}

// Variances of a triangle of weights, and of its overlap with the next.
TEST(AngleMeans, WhiteNoiseAndQuantisationHaveTheTrianglesVariance) {
  for (int level = 0; level <= 6; ++level) {
    const auto covariance = ifog::level_covariance(level);
    const double step = std::exp2(level), square = step * step;
    EXPECT_NEAR(covariance[0][kN], (2.0 * square + 1.0) / (3.0 * square), 1e-12);
    EXPECT_NEAR(covariance[1][kN], (square - 1.0) / (6.0 * square), 1e-12);
    EXPECT_NEAR(covariance[2][kN], 0.0, 1e-12);
    // The mean of so many independent errors, over the step twice.
    EXPECT_NEAR(covariance[0][kQ] * ifog::level_unit(level)[kQ], 2.0 / (step * square), 1e-15);
    EXPECT_NEAR(covariance[1][kQ] * ifog::level_unit(level)[kQ], -1.0 / (step * square), 1e-15);
  }
}

// Fourth differences of the generalised covariance of the angle's integral over time: −|t|⁵/240 for a random
// walk, −t⁴ ln|t|/24π for flicker up to t⁴, which adds one constant to every lag.
TEST(AngleMeans, SlowTermsComeToTheMeansOverTime) {
  const auto covariance = ifog::level_covariance(20);
  EXPECT_NEAR(covariance[0][kK], -7.0 / 30.0, 1e-3);
  EXPECT_NEAR(covariance[1][kK], -61.0 / 120.0, 1e-3);
  EXPECT_NEAR(covariance[300][kK], -150.0, 1e-3);
  const double flicker = (81.0 * std::log(3.0) - 96.0 * std::log(2.0)) / (24.0 * std::numbers::pi);
  EXPECT_NEAR(covariance[0][kB] - covariance[1][kB], flicker, 1e-3);
}

}  // namespace
