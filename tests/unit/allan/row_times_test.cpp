// SPDX-License-Identifier: Apache-2.0
// The times of rows whose stamps are those of an even clock, off by an amount that is known here.
#include "filters/allan/row_times.h"

#include <gtest/gtest.h>

#include <random>
#include <vector>

namespace ifog {
namespace {

TEST(RowTimes, StampsOfAnEvenClockAreTaken) {
  const std::vector<double> stamps{5.0, 5.01, 5.02, 5.03, 9.03, 9.04, 9.05};
  RowTimes times(stamps, sample_clock(stamps));
  for (const double stamp : stamps) EXPECT_DOUBLE_EQ(times.next(stamp), stamp - 5.0);
}

TEST(RowTimes, StampsThatScatterGiveWayToTheClockBehindThem) {
  std::mt19937_64 engine(3);
  std::uniform_real_distribution<double> off(-4e-3, 4e-3);
  std::vector<double> taken, stamps;
  double t = 0.0;
  for (int i = 0; i < 20000; ++i) {
    taken.push_back(t);
    stamps.push_back(1000.0 + t + off(engine));
    t += i == 7000 ? 7200.0 : 0.01;  // two hours without rows
  }
  RowTimes times(stamps, sample_clock(stamps));
  double last = -1.0;
  for (std::size_t i = 0; i < stamps.size(); ++i) {
    const double now = times.next(stamps[i]);
    if (i != 7001) {
      EXPECT_NEAR(now - last, 0.01, i > 0 ? 1e-6 : 1.0) << i;
    }
    EXPECT_NEAR(now, taken[i], 0.02) << i;
    last = now;
  }
}

}  // namespace
}  // namespace ifog
