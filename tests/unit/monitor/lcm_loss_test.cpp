// SPDX-License-Identifier: Apache-2.0
// What is lost on LCM by the messages' numbers, and which numbers are believed.
#include "tools/ifog/captures/lcm/lcm_loss.h"

#include <ifog/rate_t.hpp>

#include "msgs/in_order.h"
#include "tests/unit/test.h"

namespace ifog::tools {
namespace {

constexpr std::int64_t kMost = std::numeric_limits<std::int64_t>::max();

// Sample n of a sensor of 100 Hz.
rate_t sample(std::int64_t n) {
  rate_t out{};
  out.seq = n;
  out.utime = 1'700'000'000'000'000 + n * 10'000;
  out.sensor_time_ns = -1;
  out.dt = 0.01;
  return out;
}

TEST(LcmLoss, WhatIsPassedOverWithoutAWordIsLost) {
  LcmLoss way;
  EXPECT_EQ(way.take(sample(10)), 0);
  EXPECT_EQ(way.take(sample(11)), 0);
  way.take(sample(15));
  EXPECT_EQ(way.lost(), 3);
  rate_t told = sample(400);
  told.flags = rate_t::FLAG_GAP;
  way.take(told);
  // A day without the network.
  way.take(sample(400 + 8'640'000));
  way.take(sample(5));  // the daemon has begun again
  EXPECT_EQ(way.lost(), 3 + 8'639'999);
  EXPECT_EQ(way.restarts(), 0);
}

// One message of somebody else's among those of a sensor, with any number.
TEST(LcmLoss, ANumberThatNoSampleCanHaveIsNoLoss) {
  for (const std::int64_t forged :
       {kMost, kMost / 2, -kMost - 1, std::int64_t{-7}, std::int64_t{1'000'000}}) {
    LcmLoss way;
    for (std::int64_t n = 0; n < 400; ++n) {
      rate_t message = sample(n);
      if (n == 200) message.seq = forged;
      EXPECT_EQ(way.take(message), 0) << forged << " at " << n;
    }
    EXPECT_EQ(way.lost(), 0);
    EXPECT_EQ(way.restarts(), forged > 0 ? 1 : 0);
  }
}

// The wall clock, which labels utime, is set back while messages are lost: the sensor's own tells.
TEST(LcmLoss, AClockThatIsSetHidesNoLoss) {
  LcmLoss way;
  for (const std::int64_t n : {0, 1, 2, 5002}) {
    rate_t message = sample(n);
    message.sensor_time_ns = n * 10'000'000;
    if (n > 2) message.utime -= 3'600'000'000;
    way.take(message);
  }
  EXPECT_EQ(way.lost(), 4999);
}

// LCM promises no order: neighbours that change places are both there.
TEST(LcmLoss, MessagesThatChangePlacesAreNotLost) {
  LcmLoss way;
  std::int64_t told = 0;
  for (std::int64_t n = 0; n < 6000; n += 2) {
    const bool exchanged = n % 20 == 0;
    told += way.take(sample(exchanged ? n + 1 : n));
    told += way.take(sample(exchanged ? n : n + 1));
  }
  EXPECT_EQ(way.lost(), 0);
  EXPECT_EQ(told, 0);
  way.take(sample(6002));  // 6000 and 6001 are missing, and then one of them comes
  way.take(sample(6001));
  EXPECT_EQ(way.lost(), 1);
  for (std::int64_t n = 6003; n < 6030; ++n) told += way.take(sample(n));
  EXPECT_EQ(told, 1);
  EXPECT_FALSE(way.two_publishers());
}

// A log that is played while the daemon runs.
TEST(LcmLoss, OfTwoPublishersNothingIsKnownToBeLost) {
  LcmLoss way;
  for (std::int64_t n = 0; n < 400; ++n) {
    way.take(sample(7'272'642 + n));
    way.take(sample(n));
  }
  EXPECT_TRUE(way.two_publishers());
  EXPECT_EQ(way.lost(), 0);
  for (std::int64_t n = 400; n < 800; ++n) way.take(sample(n));
  EXPECT_FALSE(way.two_publishers());
}

std::vector<std::int64_t> in_order(const std::vector<std::int64_t>& numbers) {
  InOrder order;
  std::vector<std::int64_t> out;
  const auto sink = [&](const rate_t& message) { out.push_back(message.seq); };
  for (const std::int64_t n : numbers) order.take(sample(n), sink);
  order.flush(sink);
  return out;
}

TEST(InOrder, WhatChangedPlacesIsHandedOnByItsNumber) {
  EXPECT_EQ(in_order({1, 2, 4, 3, 5, 8, 6, 7, 9}), (std::vector<std::int64_t>{1, 2, 3, 4, 5, 6, 7, 8, 9}));
  // One that is lost holds nothing up for ever, and is no reason to leave another out.
  std::vector<std::int64_t> some, all;
  for (std::int64_t n = 0; n < 100; ++n)
    if (n != 50) some.push_back(n);
  EXPECT_EQ(in_order(some), some);
  // The daemon was started again.
  EXPECT_EQ(in_order({5000, 5001, 5003, 0, 1, 2}), (std::vector<std::int64_t>{5000, 5001, 5003, 0, 1, 2}));
}

TEST(LcmLoss, StepsThatCannotBeDoNotCount) {
  LcmLoss way;
  way.take(sample(0));
  way.take(sample(1));
  for (const double step : {1e300, -1.0, std::numeric_limits<double>::quiet_NaN()}) {
    rate_t message = sample(2);
    message.dt = step;
    way.take(message);
  }
  way.take(sample(102));
  EXPECT_EQ(way.lost(), 99);
}

}  // namespace
}  // namespace ifog::tools
