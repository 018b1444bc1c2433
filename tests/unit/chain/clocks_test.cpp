// SPDX-License-Identifier: Apache-2.0
// A device whose clock ticks hardly more often than it samples.
#include "drivers/timeline/timeline.h"
#include "filters/chain/fitted_clock.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/chain/one_axis.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// The tick is one period or several: nothing is lost, and the time elapsed is what the clock's sum says.
TEST(DevicesClock, ThatTicksHardlyMoreOftenThanItSamplesLosesNothing) {
  struct Coarse {
    double rate_hz, told_hz, tick_s;
  };
  for (const Coarse& device :
       {Coarse{999.7, 999.7, 1e-3}, Coarse{1000.3, 1000.0, 1e-3}, Coarse{5000.0, 5000.0, 1e-3},
        Coarse{400.0, 400.0, 1e-3}, Coarse{1000.0, 1000.0, 1e-3}}) {
    for (const std::uint32_t modulus : {0U, 16U}) {
      SensorFacts facts;
      facts.nominal_rate_hz = device.told_hz;
      facts.sequence_modulus = modulus;
      Incrementer incrementer(facts);
      Increment increment;
      double angle_rad = 0.0, dt_s = 0.0;
      constexpr std::uint64_t kSamples = 30'000;
      for (std::uint64_t n = 0; n < kSamples; ++n) {
        const double at_s = static_cast<double>(n) / device.rate_hz;
        Reading reading;
        reading.arrival_ns = kStart_ns + std::llround(at_s * 1e9);
        reading.valid_axes = 1;
        reading.value[0] = kTurning + 1e-9 * static_cast<double>(n % 7);
        reading.has_sequence = modulus > 0;
        reading.sequence = modulus > 0 ? static_cast<std::uint32_t>(n % modulus) : 0;
        reading.device_time_ns = std::llround(std::floor(at_s / device.tick_s + 1e-6) * device.tick_s * 1e9);
        if (!incrementer.next(reading, increment)) continue;
        angle_rad += increment.delta_theta_rad[0];
        dt_s += increment.dt_s;
      }
      const double whole_s = kSamples / device.rate_hz;
      EXPECT_EQ(incrementer.counts().missing, 0U) << device.rate_hz << ' ' << modulus;
      EXPECT_EQ(incrementer.counts().restarts, 0U) << device.rate_hz << ' ' << modulus;
      EXPECT_EQ(incrementer.counts().samples, kSamples) << device.rate_hz << ' ' << modulus;
      EXPECT_NEAR(dt_s, whole_s, 3.0 * device.tick_s) << device.rate_hz << ' ' << modulus;
      EXPECT_NEAR(angle_rad, kTurning * whole_s, 1e-3 * kTurning * whole_s)
          << device.rate_hz << ' ' << modulus;
    }
  }
}

// The least and the most of a capture's own clock are further apart than 64 bits hold.
TEST(DeviceTimeline, AClockMayJumpAcrossAllThatHasRoom) {
  Timeline timeline(0, 100.0);
  const double value = 0.5;
  Timeline::Frame frame;
  frame.clocked = true;
  frame.values = {&value, 1};
  frame.stamp_ns = -8'999'999'999'000'000'000;
  timeline.first(frame);
  frame.stamp_ns = 8'999'999'999'000'000'000;
  const Timeline::Step step = timeline.next(frame);
  EXPECT_FALSE(step.out_of_turn);
  EXPECT_TRUE(step.restarted);
  EXPECT_EQ(step.time_ns, frame.stamp_ns);
}

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

// A device that samples at another rate than the configuration says.

constexpr double kRate_hz = 100.0;

enum class Tells { nothing, counter, counter_and_clock };

SensorFacts facts_of(Tells tells, std::uint32_t modulus) {
  SensorFacts facts;
  facts.nominal_rate_hz = kRate_hz;
  facts.sequence_modulus = tells == Tells::nothing ? 0 : modulus;
  return facts;
}

Reading reading_at(double at_s, std::uint64_t n, bool counts, std::optional<double> clock_s) {
  Reading reading;
  reading.arrival_ns = kStart_ns + std::llround(at_s * 1e9);
  reading.valid_axes = 1;
  reading.value[0] = static_cast<double>(n % 7);
  reading.has_sequence = counts;
  reading.sequence = static_cast<std::uint32_t>(n % 128);
  if (clock_s) reading.device_time_ns = std::llround(*clock_s * 1e9);
  return reading;
}

TEST(Rate, ADeviceThatSendsAtAnotherRateThanItShouldIsFound) {
  for (const double rate_hz : {5.0, 50.0, 97.0, 99.99, 103.0, 180.0, 1000.0}) {
    for (const Tells tells : {Tells::nothing, Tells::counter, Tells::counter_and_clock}) {
      Incrementer incrementer(facts_of(tells, 128));
      Increment increment;
      for (std::uint64_t n = 0; n < 6000; ++n) {
        const double at_s = static_cast<double>(n) / rate_hz;
        const auto clock_s = tells == Tells::counter_and_clock ? std::optional(at_s) : std::nullopt;
        ASSERT_TRUE(incrementer.next(reading_at(at_s, n, tells != Tells::nothing, clock_s), increment));
      }
      const bool off = tells == Tells::counter && std::abs(rate_hz - kRate_hz) > 1.0;
      const double expected = off ? kRate_hz / rate_hz - 1.0 : 0.0;
      EXPECT_NEAR(incrementer.interval_error(), expected, 1e-4) << rate_hz;
      EXPECT_EQ(incrementer.counts().missing, 0U) << rate_hz;
      EXPECT_FALSE(incrementer.refused_clock()) << rate_hz;
    }
  }
}

// A candump log of the right device, by the file transport at ten times its pace.
TEST(Rate, ARecordingThatIsReplayedFasterIsOfTheRightDevice) {
  for (const Tells tells : {Tells::counter, Tells::counter_and_clock}) {
    SensorFacts facts = facts_of(tells, 128);
    facts.speed = 10.0;
    Incrementer incrementer(facts);
    Increment increment;
    for (std::uint64_t n = 0; n < 6000; ++n) {
      const double at_s = static_cast<double>(n) / kRate_hz;
      const auto clock_s = tells == Tells::counter_and_clock ? std::optional(at_s) : std::nullopt;
      ASSERT_TRUE(incrementer.next(reading_at(at_s / facts.speed, n, true, clock_s), increment));
    }
    EXPECT_EQ(incrementer.interval_error(), 0.0);
    EXPECT_FALSE(incrementer.refused_clock());
  }
}

// With a clock alone: each of its samples seems to come behind a gap, and only a part of its time is covered.
TEST(Rate, ADeviceWithAClockAloneThatSendsMoreSlowlyThanItShouldIsFound) {
  for (const double rate_hz : {30.0, 50.0, 60.0, 99.0, 103.0, 180.0}) {
    Incrementer incrementer(facts_of(Tells::nothing, 0));
    Increment increment;
    for (std::uint64_t n = 0; n < 3000; ++n) {
      const double at_s = static_cast<double>(n) / rate_hz;
      ASSERT_TRUE(incrementer.next(reading_at(at_s, n, false, at_s), increment));
    }
    EXPECT_NEAR(incrementer.interval_error(), rate_hz < 66.0 ? kRate_hz / rate_hz - 1.0 : 0.0, 1e-3)
        << rate_hz;
  }
}

// Of a device with neither, from the beginning or later, within two seconds: no time is lost, no sample missing.
TEST(Rate, DeliveriesOfManySamplesCostNoTime) {
  for (const double rate_hz : {97.5, 100.0, 102.5}) {
    for (const std::uint64_t together : {10U, 30U, 60U, 100U, 180U}) {
      for (const std::uint64_t alone_until : {0U, 1800U}) {
        Incrementer incrementer(facts_of(Tells::nothing, 0));
        Increment increment;
        double sum_s = 0.0;
        for (std::uint64_t n = 0; n < 6000; ++n) {
          const std::uint64_t many = n < alone_until ? 1 : together;
          const double sent_s = static_cast<double>((n / many + 1) * many) / rate_hz;
          Reading reading = reading_at(sent_s, n, false, std::nullopt);
          reading.at_once = static_cast<std::uint32_t>(many);
          ASSERT_TRUE(incrementer.next(reading, increment));
          sum_s += increment.dt_s;
        }
        EXPECT_NEAR(sum_s, 6000.0 / rate_hz, 0.6) << rate_hz << ' ' << together << ' ' << alone_until;
        EXPECT_EQ(incrementer.counts().missing, 0U) << rate_hz << ' ' << together;
      }
    }
  }
}

// A clock in another unit, too fast, stopped, or that jumps: after six seconds the arrivals give the time.
TEST(Rate, AClockThatArrivalsAndNominalRateContradictIsNotUsed) {
  for (const double runs : {1e-9, 1e-3, 0.8, 1.001, 1.2, 3.0, 1000.0, 0.0}) {
    for (const bool counts : {false, true}) {
      Incrementer incrementer(facts_of(counts ? Tells::counter : Tells::nothing, 128));
      Increment increment;
      double sum_s = 0.0;
      int flagged = 0;
      for (std::uint64_t n = 0; n < 1600; ++n) {
        const double at_s = static_cast<double>(n) / kRate_hz;
        const double clock_s = runs > 0.0 ? at_s * runs : std::min(at_s, 2.0);
        const double delivered_s = at_s + static_cast<double>(4 - n % 5) / kRate_hz;
        ASSERT_TRUE(incrementer.next(reading_at(delivered_s, n, counts, clock_s), increment));
        flagged += (increment.flags & kGapBefore) != 0 && (increment.flags & kSensorClockSet) != 0 ? 1 : 0;
        if (n >= 600) sum_s += increment.dt_s;
      }
      const bool good = runs == 1.001;
      EXPECT_EQ(incrementer.refused_clock().has_value(), !good) << runs << ' ' << counts;
      EXPECT_NEAR(incrementer.refused_clock().value_or(runs), runs, runs > 0.0 ? 0.02 * runs : 0.5);
      EXPECT_EQ(increment.device_time_ns < 0, !good) << runs << ' ' << counts;
      EXPECT_EQ(flagged, good ? 0 : 1) << runs << ' ' << counts;
      EXPECT_NEAR(sum_s, 10.0, 0.02) << runs << ' ' << counts;
    }
  }
}

}  // namespace
}  // namespace ifog
