// SPDX-License-Identifier: Apache-2.0
// A device that samples at another rate than the configuration says.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

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

TEST(Rate, ADeviceThatSendsAtAnotherRateThanItShouldIsFound) {
  for (const double rate_hz : {5.0, 50.0, 97.0, 99.99, 103.0, 180.0, 1000.0}) {
    for (const Tells tells : {Tells::nothing, Tells::counter, Tells::counter_and_clock}) {
      Incrementer incrementer(facts_of(tells, 128));
      Increment increment;
      for (std::uint64_t n = 0; n < 6000; ++n) {
        Reading reading;
        reading.arrival_ns = kStart_ns + std::llround(static_cast<double>(n) / rate_hz * 1e9);
        reading.valid_axes = 1;
        reading.has_sequence = tells != Tells::nothing;
        reading.sequence = static_cast<std::uint32_t>(n % 128);
        if (tells == Tells::counter_and_clock)
          reading.device_time_ns = std::llround(static_cast<double>(n) / rate_hz * 1e9);
        ASSERT_TRUE(incrementer.next(reading, increment));
      }
      const bool off = tells == Tells::counter && std::abs(rate_hz - kRate_hz) > 1.0;
      const double expected = off ? kRate_hz / rate_hz - 1.0 : 0.0;
      EXPECT_NEAR(incrementer.interval_error(), expected, 1e-4) << rate_hz;
      EXPECT_EQ(incrementer.counts().missing, 0U) << rate_hz;
    }
  }
}

// With a clock alone: each of its samples seems to come behind a gap, and only a part of its time is covered.
TEST(Rate, ADeviceWithAClockAloneThatSendsMoreSlowlyThanItShouldIsFound) {
  for (const double rate_hz : {30.0, 50.0, 60.0, 99.0, 103.0, 180.0}) {
    Incrementer incrementer(facts_of(Tells::nothing, 0));
    Increment increment;
    for (std::uint64_t n = 0; n < 3000; ++n) {
      Reading reading;
      reading.device_time_ns = std::llround(static_cast<double>(n) / rate_hz * 1e9);
      reading.arrival_ns = kStart_ns + *reading.device_time_ns;
      reading.valid_axes = 1;
      ASSERT_TRUE(incrementer.next(reading, increment));
    }
    EXPECT_NEAR(incrementer.interval_error(), rate_hz < 66.0 ? kRate_hz / rate_hz - 1.0 : 0.0, 1e-3)
        << rate_hz;
  }
}

}  // namespace
}  // namespace ifog
