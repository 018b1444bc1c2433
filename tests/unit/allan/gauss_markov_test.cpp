// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/noise/gauss_markov.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>
#include <vector>

#include "filters/allan/noise/angle_means.h"
#include "filters/allan/noise/noise_coefficients.h"
#include "tools/simulate/noise.h"

namespace {

// IEEE Std 952, annex C: exponentially correlated noise of drive q and time T.
TEST(GaussMarkov, ItsAllanVarianceIsTheStandardsIntegral) {
  const double correlation = 300.0;
  for (const double m : {0.1, 1.0, 30.0, 300.0, 567.0, 3000.0, 1e5}) {
    // The one-sided spectrum q²/(ω² + 1/T²), weighted by 2 sin⁴(πfm)/(πfm)².
    double sum = 0.0;
    const double step = 2e-4;
    for (double log_f = std::log(1e-9); log_f < std::log(40.0 / m + 1.0); log_f += step) {
      const double f = std::exp(log_f), turn = 2.0 * std::numbers::pi * f, x = std::numbers::pi * f * m;
      sum += step * f * 2.0 / (turn * turn + 1.0 / (correlation * correlation)) * 2.0 *
             std::pow(std::sin(x), 4) / (x * x);
    }
    EXPECT_NEAR(ifog::returning_variance(correlation, m) / sum, 1.0, 5e-3) << m;
  }
  // Highest at 1.89 correlation times (IEEE Std 952), a walk before, white noise behind.
  const auto at = [&](double m) { return ifog::returning_variance(correlation, m); };
  EXPECT_GT(at(1.89 * correlation), at(1.8 * correlation));
  EXPECT_GT(at(1.89 * correlation), at(2.0 * correlation));
  EXPECT_NEAR(at(0.3) / 0.1, 1.0, 1e-3);
  EXPECT_NEAR(at(3e6) * 3e6 / (correlation * correlation), 1.0, 1e-3);
}

// Eight hours of 0.003 °/√h with a bias of 0.1 °/h that remembers 300 s, in units of the white noise.
TEST(GaussMarkov, ABiasThatComesBackIsNamedWithItsTime) {
  std::vector<double> rate = ifog::simulate::noise({.N = 1.0}, 1.0, 28800, 11);
  ifog::simulate::GaussMarkov bias(0.556, 300.0, 1.0, ifog::simulate::Draw(11, 5));
  for (double& value : rate) value += bias.next();
  const std::vector<ifog::Stretch> whole{{0, rate.size()}};
  const ifog::NoiseCoefficients found = ifog::noise_coefficients(ifog::AngleSum(rate, whole), 1.0);
  ASSERT_TRUE(found.markov && found.markov->present);
  EXPECT_LT(found.markov->lower_s, 300.0);
  EXPECT_GT(found.markov->upper_s, 300.0);
  EXPECT_LT(found.markov->upper_s, 900.0);
  EXPECT_NEAR(found.markov->sigma_radps, 0.556, 0.15);
  EXPECT_NEAR(found.markov->walk, 0.556 * std::sqrt(2.0 / 300.0), 0.007);
  EXPECT_GT(found.misfit, 0.5);
  EXPECT_NE(ifog::markov_in_words(found).find("the bias is correlated"), std::string::npos);
}

TEST(GaussMarkov, AWalkAndFlickerAreNotSaidToComeBack) {
  int said = 0;
  for (std::uint64_t seed = 0; seed < 20; ++seed)
    for (const auto& levels : {ifog::simulate::NoiseLevels{.N = 1.0, .K = 0.02},
                               ifog::simulate::NoiseLevels{.N = 1.0, .B = 0.3}}) {
      const std::vector<double> rate = ifog::simulate::noise(levels, 1.0, 7200, 400 + seed);
      const std::vector<ifog::Stretch> whole{{0, rate.size()}};
      const auto found = ifog::noise_coefficients(ifog::AngleSum(rate, whole), 1.0);
      said += found.markov && found.markov->present ? 1 : 0;
      EXPECT_EQ(ifog::markov_in_words(found).empty(), !found.markov || !found.markov->present);
    }
  EXPECT_LE(said, 1);
}

}  // namespace
