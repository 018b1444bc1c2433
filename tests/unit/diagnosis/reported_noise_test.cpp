// SPDX-License-Identifier: Apache-2.0
// The noise that a diagnosis reports besides the effects.
#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

// Two hours of one a second. White noise of unit N, and a bias of sigma that forgets in 36 s; or none.
Diagnosis diagnosed(double sigma) {
  constexpr double kForgets_s = 36.0;
  const double kept = std::exp(-1.0 / kForgets_s), driven = std::sqrt(1.0 - kept * kept);
  std::vector<double> time, rate;
  double bias = 0.0;
  for (std::uint32_t i = 0; i < 7200; ++i) {
    bias = kept * bias + driven * sigma * gaussian_deviate(i, 1, 17, 8);
    time.push_back(i);
    rate.push_back(1e-6 * (bias + gaussian_deviate(i, 2, 17, 8)));
  }
  return diagnose({made_record("", time, rate)}, {});
}

TEST(ReportedNoise, ABiasThatComesBackIsThereWithItsTime) {
  const Diagnosis found = diagnosed(1.5);
  ASSERT_TRUE(found.markov.has_value());
  EXPECT_TRUE(found.markov->present);
  EXPECT_GT(36.0, found.markov->lower_s);
  EXPECT_LT(36.0, found.markov->upper_s);
  EXPECT_NEAR(found.markov->sigma_radps, 1.5e-6, 0.4e-6);
}

TEST(ReportedNoise, WhereNothingComesBackThereIsNone) {
  const Diagnosis found = diagnosed(0.0);
  EXPECT_FALSE(found.markov.has_value() && found.markov->present);
}

// A supply that is switched, twenty samples a second: what is left is the noise, to the sample.
TEST(ReportedNoise, OfAChannelThatStepsIsTheSensorsOwn) {
  std::vector<double> time, rate, supply;
  for (std::uint32_t i = 0; i < 36000; ++i) {
    const double volts = 12.0 + 0.4 * gaussian_deviate(i / 740, 3, 17, 8);
    time.push_back(0.05 * i);
    rate.push_back(1e-6 * gaussian_deviate(i, 4, 17, 8) + 1e-4 * (volts - 12.0));
    supply.push_back(volts + 1e-4 * gaussian_deviate(i, 5, 17, 8));
  }
  const Diagnosis found = diagnose({made_record("", time, rate, {{"supply_V", supply}})}, {});
  ASSERT_EQ(found.effects.size(), 1U);
  EXPECT_EQ(found.effects[0].effect.channel, "supply_V");
  EXPECT_NEAR(found.after.at("residual_rms_radps"), 1e-6, 0.02e-6);
  EXPECT_NEAR(found.after.at("rms_1s_radps"), 1e-6 / std::sqrt(20.0), 0.05e-6 / std::sqrt(20.0));
  EXPECT_FALSE(found.noise.Q.has_value());
  ASSERT_TRUE(found.noise.N.has_value());
  EXPECT_NEAR(*found.noise.N, 1e-6 * std::sqrt(0.05), 0.05e-6 * std::sqrt(0.05));
}

}  // namespace
}  // namespace ifog
