// SPDX-License-Identifier: Apache-2.0
// What is told of a device's clock sums up to what the clock itself has passed, whatever rate was configured.
#include "drivers/ifog/clock_steps.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

namespace ifog {
namespace {

struct Told {
  double worst_s = 0.0;  // of the sum beside the clock's own, ever
  double least_s = 1.0, most_s = 0.0;
};

// 20 000 samples by a counter, one each period, with a clock of so long a tick.
Told told(double nominal_s, std::int64_t period_ns, std::int64_t tick_ns) {
  ClockSteps steps(nominal_s);
  Told out;
  std::int64_t before_ns = 0;
  double sum_s = 0.0;
  for (std::int64_t i = 1; i <= 20000; ++i) {
    const std::int64_t now_ns = i * period_ns / tick_ns * tick_ns;
    const ClockSteps::Step step = steps.take(now_ns - before_ns, 1);
    before_ns = now_ns;
    sum_s += step.dt_s;
    out.worst_s = std::max(out.worst_s, std::abs(sum_s - 1e-9 * static_cast<double>(now_ns)));
    out.least_s = std::min(out.least_s, step.dt_s);
    out.most_s = std::max(out.most_s, step.dt_s);
  }
  return out;
}

// 1 kHz was configured (the default of a driver), the device sends 200 Hz, and its stamps have no more digits
// than that.
TEST(ClockSteps, ARateThatWasConfiguredWrongGivesWayToTheDevicesClock) {
  const Told slow = told(0.001, 5'000'000, 5'000'000);
  EXPECT_LT(slow.worst_s, 1e-9);
  EXPECT_NEAR(slow.least_s, 0.005, 1e-12);
  EXPECT_NEAR(slow.most_s, 0.005, 1e-12);
}

TEST(ClockSteps, TheSumStaysByTheClockWhateverTheTickAndTheNominalRate) {
  for (const double nominal_s : {0.0004, 0.001, 0.0025, 0.0037, 0.01})
    for (const std::int64_t period_ns : {1'000'000, 1'300'000, 5'000'000})
      for (const std::int64_t tick_ns : {1'000'000, 700'000, 5'000'000}) {
        const Told any = told(nominal_s, period_ns, tick_ns);
        // Until the clock has moved for the first time the nominal rate is all there is.
        const double unknown_s =
            nominal_s * (1.0 + std::ceil(static_cast<double>(tick_ns) / static_cast<double>(period_ns)));
        EXPECT_LT(any.worst_s, 4e-9 * static_cast<double>(tick_ns) + unknown_s)
            << nominal_s << " s, " << period_ns << " ns, ticks of " << tick_ns << " ns";
        EXPECT_GT(any.least_s, 0.0);
      }
}

// The clock that this is for: ticks a third longer than half a period, and the nominal rate right.
TEST(ClockSteps, TicksBesideARightRateLeaveItsPeriod) {
  const Told right = told(0.001, 1'000'000, 700'000);
  EXPECT_LT(right.worst_s, 0.0021);
}

}  // namespace
}  // namespace ifog
