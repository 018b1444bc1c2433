// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/fitted_clock.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <limits>

#include "tests/unit/chain/one_axis.h"

namespace ifog {
namespace {

TEST(FittedClock, FollowsAPeriodThatIsNotTheNominalOneAndSmoothsJitter) {
  FittedClock clock(1e-3, 5000);
  const double period_s = 1e-3 * (1.0 + 40e-6);
  double worst_s = 0.0;
  for (int n = 0; n < 50000; ++n) {
    const double jitter_s = 100e-6 * ((n * 7919) % 997) / 997.0;  // late by 0 … 100 µs
    const std::int64_t time_ns = clock.advance(1, kStart_ns + std::llround((n * period_s + jitter_s) * 1e9));
    const double mean_lateness_s = 50e-6;
    if (n > 20000)
      worst_s = std::max(worst_s, std::abs(static_cast<double>(time_ns - kStart_ns) * 1e-9 - n * period_s -
                                           mean_lateness_s));
  }
  EXPECT_LT(worst_s, 3e-6);
  EXPECT_NEAR(clock.period_s(), period_s, 1e-6 * period_s);
}

TEST(FittedClock, ALateArrivalHardlyMovesIt) {
  FittedClock clock(1e-3, 1000);
  std::int64_t time_ns = 0;
  for (int n = 0; n < 5000; ++n) {
    const std::int64_t late_ns = n == 4999 ? 50'000'000 : 0;
    time_ns = clock.advance(1, kStart_ns + std::int64_t{n} * 1'000'000 + late_ns);
  }
  EXPECT_LT(std::abs(time_ns - (kStart_ns + 4999 * std::int64_t{1'000'000})), 100'000);
}

TEST(FittedClock, GoesNoFurtherThanThereIsRoomFor) {
  constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();
  FittedClock clock(1.0, 1000);
  EXPECT_EQ(clock.advance(1, kMost - 5), kMost - 5);
  for (int n = 0; n < 20; ++n) EXPECT_EQ(clock.advance(1'000'000'000, n % 2 == 0 ? 0 : kMost), kMost);
}

}  // namespace
}  // namespace ifog
