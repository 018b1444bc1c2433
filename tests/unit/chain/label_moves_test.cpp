// SPDX-License-Identifier: Apache-2.0
// Labels where the times of arrival move against what a device counts: it stood still, was held up on its
// way, or measures at another rate from some time on. Against when each sample was taken.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <vector>

#include "filters/chain/incrementer.h"
#include "tests/unit/chain/sent_times.h"

namespace ifog {
namespace {

struct Device {
  double stated_hz;
  std::uint32_t modulus;  // 0: no counter
  bool clocked;           // by microseconds of 32 bits
};

struct Sent {
  double taken_s, arrives_s, own_s;
};

struct Got {
  IncrementerCounts counts;
  double wrong_s = 0.0;  // for so long a label was beside its sample by more than may be
  double most_s = 0.0;   // by so much
  double last_s = 0.0;
  double dt_s = 0.0;
};

double jitter_s(std::uint64_t n) { return 2e-4 * static_cast<double>(n * 7919 % 101) / 101.0; }

Got run(const Device& device, const std::vector<Sent>& sent, double may_be_s = 0.05) {
  SensorFacts facts;
  facts.nominal_rate_hz = device.stated_hz;
  facts.sequence_modulus = device.modulus;
  Incrementer incrementer(facts);
  Increment increment;
  Got got;
  for (std::size_t n = 0; n < sent.size(); ++n) {
    Reading reading;
    reading.arrival_ns = kStart_ns + std::llround(sent[n].arrives_s * 1e9);
    reading.valid_axes = 1;
    reading.value[0] = kTurning + 1e-6 * static_cast<double>(n % 1009);
    reading.has_sequence = device.modulus > 0;
    reading.sequence = device.modulus > 0 ? static_cast<std::uint32_t>(n % device.modulus) : 0;
    if (device.clocked) {
      reading.device_time_ns = std::llround(sent[n].own_s * 1e6) * 1000;
      reading.device_wrap_ns = 4'294'967'296'000;
    }
    EXPECT_TRUE(incrementer.next(reading, increment)) << n;
    got.dt_s += increment.dt_s;
    got.last_s = static_cast<double>(increment.utime_ns - kStart_ns) * 1e-9 - sent[n].taken_s;
    got.most_s = std::max(got.most_s, std::abs(got.last_s));
    if (n > 0 && std::abs(got.last_s) > may_be_s) got.wrong_s += sent[n].taken_s - sent[n - 1].taken_s;
  }
  got.counts = incrementer.counts();
  return got;
}

// The count, and the clock where there is one, go on where they stopped.
TEST(LabelMoves, ADeviceThatStoodStillIsFollowedWithinTwoSeconds) {
  for (const Device& device :
       {Device{200.0, 128, false}, Device{1000.0, 128, false}, Device{200.0, 65'536, false},
        Device{1000.0, 128, true}, Device{200.0, 0, true}})
    for (const double stood_s : {0.15, 0.3, 0.5, 0.8, 1.0, 1.2, 1.9}) {
      SCOPED_TRACE(testing::Message() << device.stated_hz << " Hz, " << device.modulus << ", clocked "
                                      << device.clocked << ", stood for " << stood_s << " s");
      std::vector<Sent> sent;
      const auto half = static_cast<std::uint64_t>(15.0 * device.stated_hz);
      for (std::uint64_t n = 0; n < 2 * half; ++n) {
        const double own_s = static_cast<double>(n) / device.stated_hz;
        const double taken_s = own_s + (n < half ? 0.0 : stood_s);
        sent.push_back({taken_s, taken_s + jitter_s(n), own_s});
      }
      const Got got = run(device, sent);
      EXPECT_LT(got.wrong_s, 2.0 + stood_s);
      EXPECT_NEAR(got.last_s, 0.0, 1e-3);
      EXPECT_EQ(got.counts.pauses, 1U);
      EXPECT_EQ(got.counts.clock_steps, 0U);
      EXPECT_EQ(got.counts.missing, 0U);
      EXPECT_NEAR(got.dt_s, 30.0, 1e-6);
    }
}

// Everything of a hold-up comes at once, also soon after the line began.
TEST(LabelMoves, WhatIsHeldUpMovesNoLabel) {
  for (const Device& device : {Device{200.0, 0, true}, Device{200.0, 128, true}, Device{200.0, 128, false}})
    for (const double begins_s : {2.0, 5.0, 20.0})
      for (const double held_s : {0.3, 1.0, 3.0, 10.0}) {
        SCOPED_TRACE(testing::Message() << device.modulus << ", clocked " << device.clocked << ", held for "
                                        << held_s << " s at " << begins_s);
        std::vector<Sent> sent;
        for (std::uint64_t n = 0; n < 10'000; ++n) {
          const double taken_s = static_cast<double>(n) / 200.0;
          const bool held = taken_s >= begins_s && taken_s < begins_s + held_s;
          sent.push_back({taken_s, held ? begins_s + held_s : taken_s + jitter_s(n), taken_s});
        }
        const Got got = run(device, sent);
        EXPECT_LT(got.most_s, 5e-3);
        EXPECT_EQ(got.counts.missing, 0U);
        EXPECT_EQ(got.counts.pauses, 0U);
      }
}

// Told to measure at another rate while it runs: its clock says how much passes, whatever is stated.
TEST(LabelMoves, AnotherRateIsFollowedByTheDevicesClock) {
  for (const std::uint32_t modulus : {128U, 65'536U})
    for (const double rate_hz : {100.0, 150.0, 400.0}) {
      SCOPED_TRACE(testing::Message() << modulus << ", " << rate_hz << " Hz");
      std::vector<Sent> sent;
      for (std::uint64_t n = 0; n < 8000; ++n) {
        const double taken_s =
            n < 4000 ? static_cast<double>(n) / 200.0 : 19.995 + static_cast<double>(n - 3999) / rate_hz;
        sent.push_back({taken_s, taken_s + jitter_s(n), taken_s});
      }
      const Got got = run({200.0, modulus, true}, sent);
      EXPECT_LT(got.most_s, 1e-3);
      EXPECT_EQ(got.counts.missing, 0U);
      EXPECT_NEAR(got.dt_s, sent.back().taken_s + 0.005, 1e-4);
    }
}

// An adapter that hands on much at a time: no pause, and no label beyond what a portion takes.
TEST(LabelMoves, PortionsAreNeitherPausesNorLate) {
  for (const double rate_hz : {50.0, 100.0, 200.0})
    for (const std::uint64_t portion : {3U, 8U, 15U}) {
      SCOPED_TRACE(testing::Message() << rate_hz << " Hz, by " << portion);
      std::vector<Sent> sent;
      for (std::uint64_t n = 0; n < 6000; ++n) {
        const auto last = static_cast<double>(n / portion * portion + portion - 1);
        sent.push_back({static_cast<double>(n) / rate_hz, last / rate_hz + jitter_s(n), 0.0});
      }
      const double takes_s = static_cast<double>(portion) / rate_hz;
      const Got got = run({rate_hz, 128, false}, sent, takes_s);
      EXPECT_EQ(got.wrong_s, 0.0);
      EXPECT_EQ(got.counts.pauses, 0U);
    }
}

}  // namespace
}  // namespace ifog
