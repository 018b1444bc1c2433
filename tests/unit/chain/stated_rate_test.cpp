// SPDX-License-Identifier: Apache-2.0
// A device that samples at another rate than the configuration says.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <optional>

#include "filters/chain/incrementer.h"
#include "tests/unit/chain/one_axis.h"

namespace ifog {
namespace {

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
