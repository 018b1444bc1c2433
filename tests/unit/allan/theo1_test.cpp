// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/theo1.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "tools/simulate/noise.h"

namespace {

// NIST SP 1065, section 5.2.18: bias of Thêo1 against the Allan variance in the mean, a + b/m^c, by
// simulation of long records; W FM 1, F FM 1.87 − 1.05/m^0.79, RW FM 2.70 − 1.53/m^0.85.
TEST(Theo1, BiasIsTheHandbooks) {
  const struct {
    ifog::simulate::NoiseLevels levels;
    ifog::TermVariances terms;
    double a, b, c;
  } cases[] = {{{.N = 1.0}, {0, 1, 0, 0}, 1.0, 0.0, 1.0},
               {{.B = 1.0}, {0, 0, 1, 0}, 1.87, -1.05, 0.79},
               {{.K = 1.0}, {0, 0, 0, 1}, 2.70, -1.53, 0.85}};
  for (const auto& c : cases) {
    const auto rate = ifog::simulate::noise(c.levels, 1.0, 256, 1);
    const std::vector<ifog::Stretch> all{{0, rate.size()}};
    for (const ifog::LongPoint& point : ifog::theo1(ifog::AngleSum(rate, all), c.terms, 0.683, 5)) {
      const double m = point.tau / 0.75;
      EXPECT_NEAR(point.bias / (c.a + c.b / std::pow(m, c.c)), 1.0, 0.05) << "tau " << point.tau;
      EXPECT_GT(point.tau, 64.0);
      EXPECT_LE(point.tau, 0.75 * 256);
    }
  }
}

TEST(Theo1, ReachesThreeQuartersOfTheRecord) {
  const auto rate = ifog::simulate::noise({.N = 1.0}, 1.0, 5000, 2);
  const std::vector<ifog::Stretch> all{{0, rate.size()}};
  const auto points = ifog::theo1(ifog::AngleSum(rate, all), {0, 1, 0, 0}, 0.683, 10);
  ASSERT_FALSE(points.empty());
  EXPECT_NEAR(points.back().tau, 3750.0, 75.0);
}

// At the longest τ an Allan variance has one difference; Thêo1 says more, and its interval holds.
TEST(Theo1, IntervalsHoldTheAllanVarianceOfAMixture) {
  constexpr int kRecords = 200;
  const ifog::TermVariances terms{0.0, 1.0, 0.0, 1e-4};
  std::vector<int> inside;
  for (int record = 0; record < kRecords; ++record) {
    const auto rate =
        ifog::simulate::noise({.N = 1.0, .K = 1e-2}, 1.0, 256, static_cast<std::uint64_t>(record));
    const std::vector<ifog::Stretch> all{{0, rate.size()}};
    const auto points = ifog::theo1(ifog::AngleSum(rate, all), terms, 0.683, 4);
    inside.resize(points.size());
    for (std::size_t i = 0; i < points.size(); ++i) {
      const double truth = std::sqrt(1.0 / points[i].tau + 1e-4 * points[i].tau / 3.0);
      inside[i] += truth >= points[i].interval.lower_radps && truth <= points[i].interval.upper_radps ? 1 : 0;
    }
  }
  // Three standard errors of the count.
  for (const int n : inside) EXPECT_NEAR(n / double{kRecords}, 0.683, 0.10);
}

}  // namespace
