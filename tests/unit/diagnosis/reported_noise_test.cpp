// SPDX-License-Identifier: Apache-2.0
// The noise that a diagnosis reports beside the effects.
#include <gtest/gtest.h>

#include <cmath>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/gaussian_deviate.h"

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
  Record record;
  record.time_s = time;
  record.rate_radps = rate;
  return diagnose({record}, {});
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

}  // namespace
}  // namespace ifog
