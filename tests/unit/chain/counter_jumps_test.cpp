// SPDX-License-Identifier: Apache-2.0
// Counter, clock and times of arrival of one device that do not agree: one of them has jumped, or the rate is
// not the stated one; against what was sent and what was lost.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>

#include "filters/chain/incrementer.h"
#include "tests/unit/chain/sent_times.h"

namespace ifog {
namespace {

struct Device {
  double stated_hz, rate_hz;
  std::uint32_t modulus;
  std::int64_t tick_ns = 0;  // of its clock; 0: it has none
  std::int64_t wrap_ns = 0;
};

// One device, told sample by sample when it measured.
class Chain {
 public:
  explicit Chain(const Device& device) : device_(device), incrementer_(facts_of(device)) {}

  // number: of its counter; own_s: its clock.
  void take(std::uint64_t number, double own_s, double arrives_s) {
    Reading reading;
    reading.arrival_ns = kStart_ns + std::llround(arrives_s * 1e9);
    reading.valid_axes = 1;
    reading.value[0] = 0.1 + 1e-6 * static_cast<double>(taken_++);
    reading.has_sequence = device_.modulus > 0;
    reading.sequence = device_.modulus > 0 ? static_cast<std::uint32_t>(number % device_.modulus) : 0;
    if (device_.tick_ns > 0) {
      reading.device_time_ns = std::llround(own_s * 1e9) / device_.tick_ns * device_.tick_ns;
      if (device_.wrap_ns > 0) *reading.device_time_ns %= device_.wrap_ns;
      reading.device_wrap_ns = device_.wrap_ns;
    }
    ASSERT_TRUE(incrementer_.next(reading, increment));
    dt_s += increment.dt_s;
    label_s = static_cast<double>(increment.utime_ns - kStart_ns) * 1e-9 - arrives_s;
  }
  [[nodiscard]] const IncrementerCounts& counts() const { return incrementer_.counts(); }

  Increment increment;
  double dt_s = 0.0, label_s = 0.0;  // the latter: of the last one, less its arrival

 private:
  static SensorFacts facts_of(const Device& device) {
    SensorFacts facts;
    facts.nominal_rate_hz = device.stated_hz;
    facts.sequence_modulus = device.modulus;
    return facts;
  }

  Device device_;
  Incrementer incrementer_;
  std::uint64_t taken_ = 0;
};

// A rate that is a few per cent beside the stated one, which ten seconds have shown.
TEST(CounterJumps, RoundsOfASilenceAreThoseOfTheRateThatTheDeviceHas) {
  for (const std::int64_t tick_ns : {0, 1000})
    for (const Device& of : {Device{1000, 962.4, 128}, Device{1000, 1030, 128}, Device{2000, 2045, 128},
                             Device{250, 257.2, 100}, Device{500, 487.5, 256}})
      for (const double silent_s : {2.5, 3.6, 8.3}) {
        SCOPED_TRACE(testing::Message() << of.stated_hz << " Hz, really " << of.rate_hz << ", silent "
                                        << silent_s << " s, tick " << tick_ns);
        const Device device{of.stated_hz, of.rate_hz, of.modulus, tick_ns};
        Chain chain(device);
        const auto lost = static_cast<std::uint64_t>(silent_s * device.rate_hz);
        const auto before = static_cast<std::uint64_t>(10.0 * device.rate_hz);
        for (std::uint64_t n = 0; n < 2 * before; ++n) {
          const std::uint64_t number = n < before ? n : n + lost;
          const double taken_s = static_cast<double>(number) / device.rate_hz;
          chain.take(number, taken_s, taken_s + 2e-4 * static_cast<double>(n * 7919 % 101) / 101.0);
        }
        EXPECT_EQ(chain.counts().missing, lost);
        EXPECT_EQ(chain.counts().restarts, 0U);
        EXPECT_NEAR(chain.label_s, 0.0, 2e-3);
        const double rate_hz = tick_ns > 0 ? device.rate_hz : device.stated_hz;
        EXPECT_NEAR(chain.dt_s, static_cast<double>(2 * before + lost) / rate_hz, 2.0 / device.rate_hz);
      }
}

// Its clock is a time of day, or goes round within the pause: it says how long that was, and the counter is
// that of a device switched on.
TEST(CounterJumps, ACounterThatBeginsAnewWhileTheClockGoesOnMakesNoSamples) {
  for (const std::uint32_t modulus : {65'536U, 4'294'967'295U})
    for (const std::int64_t wrap_ns : {std::int64_t{0}, std::int64_t{86'400'000'000'000}}) {
      SCOPED_TRACE(testing::Message() << modulus << ", wrap " << wrap_ns);
      Chain chain({250.0, 250.0, modulus, 100'000, wrap_ns});
      constexpr double kPause_s = 4.0;
      for (std::uint64_t n = 0; n < 6000; ++n) {
        const double taken_s = static_cast<double>(n) / 250.0 + (n < 3000 ? 0.0 : kPause_s);
        chain.take(n < 3000 ? 20'000 + n : n - 3000, 1000.0 + taken_s, taken_s);
      }
      EXPECT_EQ(chain.counts().restarts, 1U);
      EXPECT_NEAR(static_cast<double>(chain.counts().missing), 250.0 * kPause_s, 1.0);
      EXPECT_NEAR(chain.dt_s, 24.0 + kPause_s, 1e-3);
    }
}

// Nothing comes before it was taken.
TEST(CounterJumps, WhatClaimsMoreThanTheTimeThatHasPassedBeganAnew) {
  constexpr double kPause_s = 5.0, kClaimed_s = 9.0;
  for (const Device& device : {Device{250.0, 250.0, 65'536}, Device{250.0, 250.0, 0, 1000, 65'536'000'000}}) {
    Chain chain(device);
    for (std::uint64_t n = 0; n < 6000; ++n) {
      const double at_s = static_cast<double>(n) / 250.0;
      const auto number = n + (n < 3000 ? 0 : static_cast<std::uint64_t>(250.0 * kClaimed_s));
      chain.take(number, static_cast<double>(number) / 250.0, at_s + (n < 3000 ? 0.0 : kPause_s));
    }
    EXPECT_EQ(chain.counts().restarts, 1U);
    EXPECT_NEAR(static_cast<double>(chain.counts().missing), 250.0 * kPause_s, 1.0);
    EXPECT_NEAR(chain.dt_s, 24.0 + kPause_s, 1e-2);
    EXPECT_NEAR(chain.label_s, 0.0, 1e-3);
  }
}

// Of which several samples have the same stamp: the labels follow as they do with a finer clock.
TEST(CounterJumps, APauseOfADeviceWithACoarseClockIsFollowedByTheLabels) {
  for (const std::int64_t tick_ns : {1000, 1'000'000, 10'000'000}) {
    SCOPED_TRACE(tick_ns);
    Chain chain({5000.0, 5000.0, 65'536, tick_ns});
    constexpr double kPause_s = 5.0;
    for (std::uint64_t n = 0; n < 60'000; ++n) {
      const double own_s = static_cast<double>(n) / 5000.0;
      chain.take(n, own_s, own_s + (n < 30'000 ? 0.0 : kPause_s));
      if (n >= 40'000) {
        ASSERT_NEAR(chain.label_s, 0.0, 1e-3) << n;
      }
    }
    EXPECT_EQ(chain.counts().pauses, 1U);
    EXPECT_EQ(chain.counts().missing, 0U);
  }
}

// A fifth of a second of samples in a delivery, and the clock is set between two of these.
TEST(CounterJumps, AClockThatIsSetBetweenLongDeliveriesIsNoRestart) {
  for (const double set_s : {-100.0, 20.0, 1000.0}) {
    Chain chain({50.0, 50.0, 256, 1000});
    for (std::uint64_t n = 0; n < 2000; ++n)
      chain.take(n, 500.0 + static_cast<double>(n) / 50.0 + (n < 1000 ? 0.0 : set_s),
                 static_cast<double>(n / 10 * 10 + 9) / 50.0);
    EXPECT_EQ(chain.counts().restarts, 0U) << set_s;
    EXPECT_EQ(chain.counts().missing, 0U) << set_s;
    EXPECT_EQ(chain.counts().sensor_clock_sets, 1U) << set_s;
    EXPECT_NEAR(chain.dt_s, 40.0, 1e-6) << set_s;
  }
}

// One that measures every ten seconds, of which nobody knows when it came.
TEST(CounterJumps, AStepOfALongPeriodIsNoClockThatWasSet) {
  Incrementer incrementer([] {
    SensorFacts facts;
    facts.nominal_rate_hz = 0.1;
    facts.sequence_modulus = 256;
    return facts;
  }());
  Increment increment;
  for (std::uint64_t n = 0; n < 500; ++n) {
    Reading reading;
    reading.valid_axes = 1;
    reading.has_sequence = true;
    reading.sequence = static_cast<std::uint32_t>(n % 256);
    reading.device_time_ns = static_cast<std::int64_t>(n) * 10'000'000'000 + (n % 2 == 0 ? 0 : 50'000'000);
    ASSERT_TRUE(incrementer.next(reading, increment));
  }
  EXPECT_EQ(incrementer.counts().sensor_clock_sets, 0U);
  EXPECT_EQ(incrementer.counts().missing, 0U);
}

}  // namespace
}  // namespace ifog
