// SPDX-License-Identifier: Apache-2.0
#include "filters/chain/incrementer.h"
#include "tests/unit/chain/one_axis.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kNominal_hz = 1000.0;
constexpr std::int64_t kPeriod_ns = 1'000'000;

SensorFacts counting_rate_sensor() {
  SensorFacts facts;
  facts.sequence_modulus = 128;
  facts.nominal_rate_hz = kNominal_hz;
  return facts;
}

// Sample number n of a device that counts modulo 128 and was switched on at kStart_ns.
Reading sample(std::uint64_t n, double value) {
  Reading reading;
  reading.arrival_ns = kStart_ns + static_cast<std::int64_t>(n) * kPeriod_ns;
  reading.sequence = static_cast<std::uint32_t>(n % 128);
  reading.has_sequence = true;
  reading.valid_axes = 1;
  reading.value[0] = value;
  return reading;
}

// More than half a rollover, of a coarse sensor at rest, whose frames are all equal; and of a recording whose
// arrivals do not show the loss, but counter and clock do.
TEST(Incrementer, ALossIsNoneOfAFrameThatCameBefore) {
  for (const bool clocked : {false, true}) {
    for (const std::uint64_t lost : {10U, 64U, 80U, 100U, 126U}) {
      Incrementer incrementer(counting_rate_sensor());
      Increment increment;
      double sum_s = 0.0;
      for (std::uint64_t n = 0; n < 3000; ++n) {
        const std::uint64_t at = n < 1000 ? n : n + lost;
        Reading reading = sample(at, 2.0 + (clocked ? 1e-6 * static_cast<double>(n) : 0.0));
        if (clocked) {
          reading.device_time_ns = static_cast<std::int64_t>(at) * kPeriod_ns;
          reading.arrival_ns = kStart_ns + static_cast<std::int64_t>(n) * kPeriod_ns;
        }
        ASSERT_TRUE(incrementer.next(reading, increment)) << lost;
        sum_s += increment.dt_s;
      }
      EXPECT_EQ(incrementer.counts().missing, lost) << clocked;
      EXPECT_EQ(incrementer.counts().restarts, 0U) << clocked << ' ' << lost;
      EXPECT_NEAR(sum_s, 1e-3 * static_cast<double>(3000 + lost), 1e-9) << clocked << ' ' << lost;
    }
  }
}

TEST(Incrementer, AfterReopeningTheNextSampleIsFlaggedEvenWhereTheCounterFits) {
  Incrementer incrementer(counting_rate_sensor());
  Increment increment;
  ASSERT_TRUE(incrementer.next(sample(0, 1.0), increment));
  incrementer.discontinuity();
  ASSERT_TRUE(incrementer.next(sample(129, 1.0), increment));
  EXPECT_EQ(increment.flags, kGapBefore);
  EXPECT_EQ(increment.sequence, 129U);
}

// One that can be used is in the table of events (tests/unit/drivers/timeline_truth_test.cpp).
TEST(Incrementer, AFrameThatComesTwiceIsCountedAlsoWhereItsAxisIsNotUsable) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  Incrementer incrementer(counting_rate_sensor());
  Increment increment;
  ASSERT_TRUE(incrementer.next(sample(0, 1.0), increment));
  ASSERT_TRUE(incrementer.next(sample(1, kNone), increment));
  EXPECT_FALSE(incrementer.next(sample(1, kNone), increment));
  EXPECT_EQ(incrementer.counts().repeated, 1U);
  EXPECT_EQ(incrementer.counts().samples, 2U);
}

TEST(Incrementer, AWrappingAngleIsFollowedThroughWrapsAndGaps) {
  SensorFacts facts = counting_rate_sensor();
  facts.kind = SensorKind::angle;
  facts.angle_wrap_rad = 2.0 * std::numbers::pi;
  Incrementer incrementer(facts);
  Increment increment;
  const double step = 0.1;
  double sum = 0.0;
  std::uint64_t last = 0;
  for (std::uint64_t n = 0; n < 2000; ++n) {
    if (n % 50 > 40) continue;  // nine samples lost in fifty: 1 rad, less than half a wrap
    const double angle = std::fmod(step * static_cast<double>(n), facts.angle_wrap_rad);
    ASSERT_TRUE(incrementer.next(sample(n, angle), increment));
    if (n > 0) {
      EXPECT_NEAR(increment.covered_s[0], increment.dt_s, 1e-15);
      EXPECT_NEAR(increment.rate_radps[0], step * kNominal_hz, 1e-9);
    }
    sum += increment.delta_theta_rad[0];
    last = n;
  }
  EXPECT_NEAR(sum, step * static_cast<double>(last), 1e-10);
}

TEST(Incrementer, ADeviceWithNeitherCounterNorClockIsTimedByArrival) {
  SensorFacts facts;
  facts.nominal_rate_hz = 100.0;
  Incrementer incrementer(facts);
  Increment increment;
  constexpr double kTruePeriod_s = 0.01 * 1.025;  // the sample clock is 2.5 % slow
  double time_s = 0.0;
  for (int n = 0; n < 20000; ++n) {
    Reading reading;
    const double jitter_s = 0.0004 * ((n * 7919) % 101) / 101.0;
    reading.arrival_ns = kStart_ns + std::llround((n * kTruePeriod_s + jitter_s) * 1e9);
    reading.valid_axes = 1;
    reading.value[0] = 1.0;
    ASSERT_TRUE(incrementer.next(reading, increment));
    if (n >= 10000) time_s += increment.dt_s;
  }
  EXPECT_NEAR(time_s, 10000 * kTruePeriod_s, 1e-5 * 10000 * kTruePeriod_s);
  EXPECT_NEAR(incrementer.clock_offset_ppm(), 25000.0, 5.0);
  EXPECT_EQ(incrementer.counts().gaps, 0U);
}

// Specific force times the time it was measured over: nothing for what is missing, and nothing that is held.
TEST(Incrementer, VelocityIsWhatWasMeasured) {
  SensorFacts facts = counting_rate_sensor();
  facts.frame_channels = facts.channels = 2;
  facts.acceleration_channel = {-1, 1, -1};
  Incrementer incrementer(facts);
  Increment increment, sum;
  const auto next = [&](std::uint64_t n, double acceleration, bool fresh) {
    Reading reading = sample(n, 1.0);
    reading.channel[1] = acceleration;
    reading.fresh_channels = fresh ? 2 : 0;
    ASSERT_TRUE(incrementer.next(reading, increment));
    n == 0 ? sum = increment : (merge(sum, increment), sum);
  };
  next(0, 2.0, true);
  EXPECT_NEAR(increment.delta_v_mps[1], 2e-3, 1e-18);
  EXPECT_EQ(increment.delta_v_mps[0], 0.0);
  EXPECT_EQ(increment.moved_s[0], 0.0);
  next(1, 99.0, false);
  EXPECT_EQ(increment.delta_v_mps[1], 0.0);
  EXPECT_EQ(increment.moved_s[1], 0.0);
  next(5, 4.0, true);  // three are missing
  EXPECT_NEAR(increment.delta_v_mps[1], 4e-3, 1e-15);
  EXPECT_NEAR(increment.moved_s[1], 1e-3, 1e-15);
  next(6, std::numeric_limits<double>::infinity(), true);
  EXPECT_EQ(increment.delta_v_mps[1], 0.0);
  EXPECT_NEAR(sum.delta_v_mps[1], 6e-3, 1e-15);
  EXPECT_NEAR(sum.moved_s[1], 2e-3, 1e-15);
}

TEST(Merge, AddsAnglesTimesAndCounts) {
  Incrementer incrementer(counting_rate_sensor());
  Increment sum, next;
  ASSERT_TRUE(incrementer.next(sample(0, 1.0), sum));
  for (std::uint64_t n = 1; n < 10; ++n) {
    ASSERT_TRUE(incrementer.next(sample(n, 1.0 + static_cast<double>(n)), next));
    merge(sum, next);
  }
  EXPECT_EQ(sum.samples, 10U);
  EXPECT_EQ(sum.sequence, 9U);
  EXPECT_NEAR(sum.delta_theta_rad[0], 55e-3, 1e-16);
  EXPECT_NEAR(sum.dt_s, 10e-3, 1e-16);
  EXPECT_NEAR(sum.rate_radps[0], 5.5, 1e-13);
  EXPECT_EQ(sum.flags & kMerged, kMerged);
}

// NTP slews it by up to a twelfth of the time: the labels follow, and nobody set it. One that is set is in the table of events.
TEST(Incrementer, ASlewedWallClockIsFollowedAndNotFlagged) {
  Incrementer incrementer(counting_rate_sensor());
  Increment increment;
  for (std::uint64_t n = 0; n < 10'000; ++n) {
    Reading reading = sample(n, 0.1);
    reading.read_ns = reading.arrival_ns;
    reading.wall_shift_ns = static_cast<std::int64_t>(n) * 83'333;
    ASSERT_TRUE(incrementer.next(reading, increment));
    ASSERT_EQ(increment.flags, 0U) << n;
    ASSERT_NEAR(increment.dt_s, 1e-3, 1e-12);
    ASSERT_NEAR(static_cast<double>(increment.utime_ns - reading.arrival_ns - reading.wall_shift_ns), 0.0,
                1e5);
  }
  EXPECT_EQ(incrementer.counts().clock_steps, 0U);
}

// A signed stamp of milliseconds that rolls over, and one that counts up to a moment; 20 samples are lost
// where they are below 0.
TEST(Incrementer, AStampBelowZeroIsAClock) {
  for (const std::int64_t wrap_ns : {std::int64_t{65'536'000'000}, std::int64_t{0}}) {
    SensorFacts facts;
    facts.nominal_rate_hz = 200.0;
    Incrementer incrementer(facts);
    Increment increment;
    double dt_s = 0.0;
    std::int64_t first_ns = 0, least_ns = 0;
    for (std::int64_t n = 0; n < 40'000; ++n) {
      if (n >= 9000 && n < 9020) continue;
      Reading reading;
      reading.arrival_ns = kStart_ns + n * 5'000'000;
      reading.valid_axes = 1;
      reading.value[0] = 1e-6 * static_cast<double>(n);
      const std::int64_t ms = 5 * n;
      reading.device_time_ns = (wrap_ns > 0 ? static_cast<std::int16_t>(ms) : ms - 300'000) * 1'000'000;
      reading.device_wrap_ns = wrap_ns;
      ASSERT_TRUE(incrementer.next(reading, increment)) << n;
      dt_s += increment.dt_s;
      if (n == 0) first_ns = least_ns = increment.device_time_ns;
      least_ns = std::min(least_ns, increment.device_time_ns);
    }
    EXPECT_EQ(incrementer.counts().missing, 20U);
    EXPECT_EQ(incrementer.counts().gaps, 1U);
    EXPECT_NEAR(dt_s, 200.0, 1e-9);
    EXPECT_EQ(increment.device_time_ns - first_ns, 199'995'000'000);
    EXPECT_EQ(least_ns, wrap_ns > 0 ? 0 : -300'000'000'000);
  }
}

}  // namespace
}  // namespace ifog
