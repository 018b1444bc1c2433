// SPDX-License-Identifier: Apache-2.0
// How many of the steps that can be found in ten minutes are, and what the test learns meanwhile. Oracles:
// closed forms for one window of ten minutes and for sums of a moving average.
#include <gtest/gtest.h>

#include <boost/math/distributions/normal.hpp>
#include <boost/math/distributions/students_t.hpp>
#include <cmath>
#include <random>

#include "daemon/health/step_test.h"

namespace ifog {
namespace {

constexpr double kMonth = 259200.0;  // blocks
constexpr int kTenMinutes = 60;

// Of a level that is known: nothing of a step is taken for it.
LevelNoise::Innovation known(double value) {
  LevelNoise::Innovation out;
  out.known = true;
  out.value = value;
  out.spread = 1.0;
  out.keep.fill(1.0);
  return out;
}

// What one window of so many blocks exceeds, on either side, once in so many.
double threshold(double window, double blocks) {
  double low = 2.0, high = 9.0;
  for (int halvings = 0; halvings < 60; ++halvings) {
    const double middle = 0.5 * (low + high);
    (exceeded_per_block(middle, 1.0 / window) > 1.0 / blocks ? low : high) = middle;
  }
  return high;
}

TEST(StepTest, FindsWhatOneWindowOfTenMinutesCouldFind) {
  const auto window = static_cast<double>(StepTest::kLengths.back());
  const double deviations = threshold(window, kMonth);  // of the step: one window would find half of them
  const double step = deviations / std::sqrt(window);
  std::mt19937_64 random(21);
  std::normal_distribution<double> normal;
  StepTest learned(kMonth);
  for (int i = 0; i < 400000; ++i) (void)learned.take(known(normal(random)));
  learned.restart();
  int found = 0;
  constexpr int kTrials = 4000;
  for (int trial = 0; trial < kTrials; ++trial) {
    StepTest test = learned;
    for (int i = 0; i < kTenMinutes; ++i) (void)test.take(known(normal(random)));
    for (int i = 0; i < kTenMinutes; ++i)
      if (test.take(known(step + normal(random)))) {
        ++found;
        break;
      }
  }
  // Half, and what other windows add to it at other blocks. Were the longest given half of the alarms, it
  // would be 52 %; a standard error is 0.8.
  EXPECT_GT(static_cast<double>(found) / kTrials, 0.545);
}

// The variance of sums is not known better than by those that were seen: at first by as many as the noise's
// law is believed like. Oracle: Student's distribution.
TEST(StepTest, AllowsForTheNoiseAsFarAsItIsKnown) {
  constexpr double kBelievedLike = 100.0;
  const auto window = static_cast<double>(StepTest::kLengths.back());
  for (const double z : {3.5, 4.0, 4.5}) {
    StepTest test(1e9);
    for (int i = 0; i < static_cast<int>(window); ++i) ASSERT_FALSE(test.take(known(z / std::sqrt(window))));
    const boost::math::normal normal;
    const boost::math::students_t student(kBelievedLike);
    const double as_rare = quantile(complement(normal, cdf(complement(student, z))));
    const double expected = exceeded_per_block(as_rare, 1.0 / window) / StepTest::kShares.back() * 1e9;
    EXPECT_NEAR(test.nearest() / expected, 1.0, 0.05) << z;
  }
}

// Innovations of a filter that takes the level for quicker than it is have sums that vary by less.
TEST(StepTest, LearnsThatSumsVaryByLess) {
  constexpr double kFollows = 0.1;
  constexpr int kWhite = 4000, kBlocks = 40000;
  std::mt19937_64 random(22);
  std::normal_distribution<double> normal;
  StepTest test(1e9);
  double last = 0.0;
  for (int i = 0; i < kBlocks; ++i) {
    const double fresh = normal(random), follows = i < kWhite ? 0.0 : kFollows;
    (void)test.take(known((fresh - follows * last) / std::sqrt(1.0 + follows * follows)));
    last = fresh;
  }
  test.restart();
  const auto window = static_cast<double>(StepTest::kLengths.back());
  const double step = 5.0 / std::sqrt(window);
  for (int i = 0; i < static_cast<int>(window); ++i) ASSERT_FALSE(test.take(known(step)));
  // Of n values of such an average; and what was learned at first counts for a hundredth.
  const double sums =
      ((1.0 - kFollows) * (1.0 - kFollows) + 2.0 * kFollows / window) / (1.0 + kFollows * kFollows);
  const double variance = sums + 0.01 * (1.0 - sums);
  const auto alarms = [&](double of_variance) {
    return exceeded_per_block(5.0 / std::sqrt(of_variance), 1.0 / window) / StepTest::kShares.back() * 1e9;
  };
  // Learned from 500 independent sums: to three standard errors of 6.3 %, the one that is allowed for
  // included.
  EXPECT_LT(test.nearest(), alarms(variance * 1.19));
  EXPECT_GT(test.nearest(), alarms(variance * 0.81));
  EXPECT_LT(test.nearest(), 0.9 * alarms(1.0));
}

}  // namespace
}  // namespace ifog
