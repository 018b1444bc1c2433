// SPDX-License-Identifier: Apache-2.0
// A bank of filters at rest: whatever its weights do, nothing comes out that did not go in.
#include <gtest/gtest.h>

#include <algorithm>
#include <array>

#include "tests/unit/estimator/drive.h"

namespace {

using namespace ifog::test;

// Measured noise of the kind an ADIS16405 has: a walk far below the noise, neighbours a little correlated.
constexpr double kWalk = 3e-7;

Record correlated(std::uint64_t seed, int length, double correlation) {
  std::mt19937_64 random(seed);
  std::normal_distribution<double> normal;
  Record made;
  double walk = 0.0, noise = normal(random);
  for (int i = 0; i < length; ++i) {
    walk += std::sqrt(kWalk) * normal(random);
    noise = correlation * noise + std::sqrt(1 - correlation * correlation) * normal(random);
    made.truth.push_back(walk);
    made.measured.push_back(walk + noise);
  }
  return made;
}

ifog::FilterSettings bank(bool conserve) {
  ifog::FilterSettings settings = told(kWalk);
  settings.rule = "mmae";
  settings.conserve_angle = conserve;
  return settings;
}

// The lags of the bank's filters are up to five powers of ten apart, and the likeliest changes at rest. A
// change of lag is no rotation, so no angle is to be paid back for it.
TEST(BankAtRest, PaysNoAngleForAChangeOfWeights) {
  for (const double correlation : {0.0, 0.4}) {
    const Record record = correlated(1, 50'000, correlation);
    const Filtered kept = run(bank(true), record.measured), plain = run(bank(false), record.measured);
    double most = 0.0;
    // At the beginning it may be under way, and what it falls short of is owed.
    for (std::size_t i = 1000; i < kept.denoised.size(); ++i)
      most = std::max(most, std::abs(kept.denoised[i] - plain.denoised[i]));
    EXPECT_LT(most, 0.2) << "sigma of one sample, correlation " << correlation;
  }
}

// Neighbours in the bank hardly differ in the likelihood of a sample, so evidence has to be kept for long.
TEST(BankAtRest, IsAsQuietAsTheRightFilterInTheEnd) {
  constexpr std::size_t kLearned = 20'000;
  const std::array<std::array<double, 2>, 2> kinds{{{0.0, 1.05}, {0.17, 1.25}}};
  for (const auto& [correlation, most] : kinds) {
    const Record record = correlated(2, 200'000, correlation);
    const Filtered got = run(bank(false), record.measured);
    const double right = mean_square_error(told_the_truth(record.measured, kWalk), record.truth, kLearned);
    EXPECT_LT(mean_square_error(got.denoised, record.truth, kLearned), most * most * right)
        << "correlation " << correlation;
  }
}

}  // namespace
