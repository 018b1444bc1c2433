// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/latency.h"

#include <gtest/gtest.h>

namespace ifog {
namespace {

TEST(LatencyHistogram, PercentilesAreRightToANinth) {
  LatencyHistogram histogram;
  for (std::int64_t ns = 1; ns <= 1'000'000; ns += 10) histogram.add(ns);  // even between 0 and 1 ms
  EXPECT_NEAR(histogram.percentile_us(0.5), 500.0, 0.125 * 500.0);
  EXPECT_NEAR(histogram.percentile_us(0.99), 990.0, 0.125 * 990.0);
  EXPECT_NEAR(histogram.max_us(), 1000.0, 0.02);
  EXPECT_LE(histogram.percentile_us(1.0), histogram.max_us());
  histogram.clear();
  EXPECT_EQ(histogram.count(), 0U);
  EXPECT_EQ(histogram.percentile_us(0.5), 0.0);
}

TEST(LatencyHistogram, TakesWhatCannotBe) {
  LatencyHistogram histogram;
  histogram.add(-5);
  histogram.add(INT64_MAX);
  EXPECT_EQ(histogram.count(), 2U);
}

}  // namespace
}  // namespace ifog
