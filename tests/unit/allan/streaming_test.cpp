// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/streaming.h"

#include <gtest/gtest.h>

#include <cmath>

#include "filters/allan/deviation.h"
#include "tools/simulate/noise.h"

namespace {

TEST(StreamingAllan, FollowsTheWholeRecordsDeviation) {
  auto rate = ifog::simulate::noise({.N = 1e-6, .K = 1e-8}, 1.0, 1U << 18U, 3);
  for (double& r : rate) r += 1.0;  // a bias a million times the noise
  ifog::StreamingAllan streaming;
  for (const double r : rate) streaming.add(r);
  const std::vector<ifog::Stretch> all{{0, rate.size()}};
  std::vector<std::size_t> m;
  for (int k = 0; k < streaming.octaves(); ++k) m.push_back(std::size_t{1} << k);
  ASSERT_EQ(m.size(), 18U);
  const auto points = ifog::deviation(ifog::AngleSum(rate, all), m);
  for (std::size_t k = 0; k < m.size(); ++k) {
    const double exact = std::sqrt(points[k].variance);
    // Octaves 0 and 1 use every place and are the same sum; above, every quarter: a few per cent of the
    // point's own error.
    const double error = 0.5 * std::sqrt(static_cast<double>(m[k]) / static_cast<double>(rate.size()));
    EXPECT_NEAR(streaming.deviation(static_cast<int>(k)) / exact, 1.0, k < 2 ? 1e-9 : 1e-9 + 0.8 * error)
        << m[k];
  }
}

TEST(StreamingAllan, CountsWhatTheDefinitionCounts) {
  // A ramp of one a sample: every difference at m is m, whatever the place.
  ifog::StreamingAllan streaming;
  for (int i = 0; i < 64; ++i) streaming.add(i);
  EXPECT_EQ(streaming.octaves(), 6);
  for (int k = 0; k < 6; ++k) EXPECT_DOUBLE_EQ(streaming.deviation(k), std::exp2(k) / std::sqrt(2.0)) << k;
  EXPECT_EQ(streaming.differences(0), 63U);
  EXPECT_EQ(streaming.differences(1), 61U);
  EXPECT_EQ(streaming.differences(2), 57U);
  EXPECT_EQ(streaming.differences(3), 25U);
  EXPECT_EQ(streaming.differences(5), 1U);
  EXPECT_TRUE(std::isnan(streaming.deviation(6)));
}

TEST(StreamingAllan, NothingReachesAcrossAGap) {
  ifog::StreamingAllan streaming;
  for (int i = 0; i < 1000; ++i) streaming.add(1.0);
  streaming.add(std::nan(""));
  for (int i = 0; i < 1000; ++i) streaming.add(5.0);
  streaming.restart();
  for (int i = 0; i < 1000; ++i) streaming.add(-5.0);
  for (int k = 0; k < streaming.octaves(); ++k) EXPECT_EQ(streaming.deviation(k), 0.0);
  EXPECT_EQ(streaming.differences(0), 3U * 999U);
}

}  // namespace
