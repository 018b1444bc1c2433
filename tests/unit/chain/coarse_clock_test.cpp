// SPDX-License-Identifier: Apache-2.0
// A device whose clock ticks hardly more often than it samples.
#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>

#include "drivers/timeline/timeline.h"
#include "filters/chain/incrementer.h"
#include "tests/unit/chain/one_axis.h"

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

}  // namespace
}  // namespace ifog
