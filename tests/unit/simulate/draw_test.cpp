// SPDX-License-Identifier: Apache-2.0
#include "tools/simulate/draw.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace {

using ifog::simulate::Draw;

TEST(Draw, LogarithmAgreesWithTheLibrarys) {
  for (double x = 1e-16; x < 1.0; x *= 1.37)
    EXPECT_NEAR(ifog::simulate::plain_log(x) / std::log(x), 1.0, 4e-16) << x;
}

TEST(Draw, QuantileInvertsTheErrorFunction) {
  for (double p = 1e-15; p < 0.5; p *= 1.9) {
    const double z = ifog::simulate::normal_quantile(p);
    EXPECT_NEAR(0.5 * std::erfc(-z / std::numbers::sqrt2) / p, 1.0, 5e-14) << p;
    if (p > 1e-6) {  // 1 − p is rounded
      EXPECT_NEAR(ifog::simulate::normal_quantile(1.0 - p), -z, 1e-9) << p;
    }
  }
  EXPECT_EQ(ifog::simulate::normal_quantile(0.5), 0.0);
}

TEST(Draw, MomentsAreTheNormalDistributions) {
  Draw draw(7, 3);
  constexpr int kDraws = 2'000'000;
  double m1 = 0, m2 = 0, m4 = 0, lag = 0, before = 0;
  for (int i = 0; i < kDraws; ++i) {
    const double x = draw.normal();
    m1 += x;
    m2 += x * x;
    m4 += x * x * x * x;
    lag += x * before;
    before = x;
  }
  const double root = std::sqrt(static_cast<double>(kDraws));  // 4.5 standard errors each
  EXPECT_LT(std::abs(m1 / kDraws), 4.5 / root);
  EXPECT_LT(std::abs(m2 / kDraws - 1.0), 4.5 * std::sqrt(2.0) / root);
  EXPECT_LT(std::abs(m4 / kDraws - 3.0), 4.5 * std::sqrt(96.0) / root);
  EXPECT_LT(std::abs(lag / kDraws), 4.5 / root);
}

TEST(Draw, SeedAndStreamNameTheSequence) {
  Draw a(5, 1), same(5, 1), stream(5, 2), seed(6, 1);
  int equal = 0;
  for (int i = 0; i < 100; ++i) {
    const double x = a.uniform();
    EXPECT_EQ(x, same.uniform());
    equal += x == stream.uniform();
    equal += x == seed.uniform();
  }
  EXPECT_EQ(equal, 0);
}

// The bits themselves, so that a change of the generator cannot pass unseen: captures are quoted by their
// seed.
TEST(Draw, FirstValuesStayWhatTheyAre) {
  Draw draw(1, 0);
  EXPECT_EQ(draw.uniform(), 0x1.ee7244f7a31f7p-1);
  EXPECT_EQ(draw.normal(), -0x1.a823b96801e7cp+0);
}

TEST(Draw, WholeNumbersAreEquallyLikely) {
  Draw draw(1, 0);
  std::array<int, 6> counts{};
  for (int i = 0; i < 6000; ++i) ++counts[draw.below(6)];
  for (const int count : counts) EXPECT_NEAR(count, 1000, 4.5 * std::sqrt(6000.0 * 5 / 36));
}

}  // namespace
