// SPDX-License-Identifier: Apache-2.0
// Samples of a driver as a capture: the devices that the chain's tests have, too
// (tests/unit/drivers/timeline_truth_test.cpp).
#include "drivers/capture/times/sample_times.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

// Ten seconds of 1 °/s are lost, some rollovers of the counter: no row turns faster or slower, and one that
// may have gone half way round has no rate.
TEST(CaptureBuilder, OfAnAngleOverASilenceNoRateIsMadeUp) {
  constexpr double kRate = std::numbers::pi / 180.0;
  for (const double wrap : {0.0, 8.0 * std::numbers::pi / 180.0}) {
    ifog_description d{};
    d.axes = 1;
    d.kind = IFOG_ANGLE;
    d.angle_wrap_rad = wrap;
    d.nominal_rate_hz = 500.0;
    d.sequence_modulus = 256;
    test::Built builder(d);
    for (int n = 0; n < 10'000; ++n) {
      if (n >= 2500 && n < 7500) continue;
      ifog_sample sample{};
      sample.arrival_ns = kStart_ns + std::int64_t{n} * 2'000'000 + n % 7 * 10'000;
      sample.valid_axes = 1;
      sample.value[0] = wrap > 0.0 ? std::remainder(kRate * n / 500.0, wrap) : kRate * n / 500.0;
      sample.flags = IFOG_SAMPLE_SEQUENCE;
      sample.sequence = static_cast<std::uint32_t>(n) % 256U;
      builder.add(sample);
    }
    EXPECT_EQ(builder.counts().missing, 5000U) << wrap;
    const Capture made = builder.finish();
    ASSERT_EQ(made.size(), 5000U) << wrap;
    int without = 0;
    for (std::size_t i = 1; i < made.size(); ++i) {
      const double rate = made.rate_radps[0][i];
      without += std::isnan(rate) ? 1 : 0;
      EXPECT_FALSE(std::abs(rate - kRate) > 1e-6) << i << ": " << rate;
    }
    EXPECT_EQ(without, wrap > 0.0 ? 1 : 0) << wrap;
  }
}

ifog_description description(double rate_hz, std::uint32_t modulus = 0) {
  ifog_description out{};
  out.axes = 1;
  out.nominal_rate_hz = rate_hz;
  out.sequence_modulus = modulus;
  return out;
}

ifog_sample sample(std::int64_t arrival_ns, int number) {
  ifog_sample out{};
  out.arrival_ns = arrival_ns;
  out.valid_axes = 1;
  out.value[0] = number;
  return out;
}

constexpr std::int64_t kEpoch_ns = 1'763'000'000'000'000'000, kStep_ns = 10'000'000;

TEST(SampleTimes, ArrivalsCountFromTheFirstUnlessTheyAreALogsOwnStamps) {
  SampleTimes counted(description(0.0)), kept(description(0.0));
  kept.keep_stamps(0);
  for (int i = 0; i < 100; ++i) {
    EXPECT_EQ(counted.next(sample(kEpoch_ns + kStep_ns * i, i))->since_s, i / 100.0);
    EXPECT_EQ(kept.next(sample(kEpoch_ns + kStep_ns * i, i))->since_s, i / 100.0);
  }
  EXPECT_EQ(counted.origin(), TimeOrigin{});
  EXPECT_EQ(kept.origin(), (TimeOrigin{1'763'000'000, 0}));
}

TEST(SampleTimes, ACounterCountsOnFromALogsFirstStamp) {
  SampleTimes times(description(100.0, 256));
  times.keep_stamps(0);
  for (int i = 0; i < 1000; ++i) {
    ifog_sample one = sample(50'000'000'000 + kStep_ns * i + i % 7 * 100'000, i);  // stamps that scatter
    one.flags = IFOG_SAMPLE_SEQUENCE;
    one.sequence = static_cast<std::uint32_t>(i % 256);
    // The double nearest to the decimal time, not a sum of two.
    EXPECT_EQ(times.next(one)->since_s, (5000 + i) / 100.0) << i;
  }
}

// As a serial adapter hands on what a device with neither counter nor clock sends: what came within 16 ms at
// once, or five at a time. The device's own rate is not quite the nominal one.
TEST(SampleTimes, OfADeliveryEverySampleHasATimeOfItsOwn) {
  struct Line {
    double nominal_hz, rate_hz, every_s;
    double phase = 0.0;  // of the delivery, in which the first comes
  };
  for (const Line line :
       {Line{100, 100, 0.016}, Line{100, 97, 0.016}, Line{100, 102.5, 0.016}, Line{1000, 1000, 0.016},
        Line{100, 100, 0.05}, Line{100, 98, 0.05}, Line{100, 100, 0.016, 0.99}, Line{1000, 1000, 0.016, 0.99},
        Line{1000, 1000, 0.016, 0.6}, Line{100, 100, 0.05, 0.99}, Line{50, 50, 0.016, 0.3}}) {
    SampleTimes times(description(line.nominal_hz));
    times.allow_restarts();
    constexpr int kSamples = 20'000;
    double last_s = 0.0, half_s = 0.0;
    for (int i = 0; i < kSamples; ++i) {
      const double measured_s = i / line.rate_hz;
      const double came_s = std::ceil(measured_s / line.every_s + line.phase + 1e-9) * line.every_s;
      const auto taken = times.next(sample(kEpoch_ns + std::llround(came_s * 1e9), i));
      ASSERT_TRUE(taken) << line.rate_hz << ", " << i;
      if (i > 0) {
        EXPECT_GT(taken->since_s - last_s, 0.45 / line.nominal_hz) << line.rate_hz << ", " << i;
        EXPECT_LT(taken->since_s - last_s, 1.5 / line.nominal_hz) << line.rate_hz << ", " << i;  // no gap
      }
      EXPECT_TRUE(i < 10 || taken->period_s == 1.0 / line.nominal_hz);
      last_s = taken->since_s;
      if (i == kSamples / 2) half_s = last_s;
    }
    EXPECT_EQ(times.counts().repeated, 0U);
    EXPECT_EQ(times.counts().missing, 0U);
    EXPECT_NEAR((kSamples / 2 - 1) / (last_s - half_s), line.rate_hz, 5e-4 * line.rate_hz);
  }
}

// Of a device with neither counter nor clock: what was held up on its way and then comes at once, or quicker
// than it was measured, has its times all the same, and a hole is one.
TEST(SampleTimes, AHoldUpIsNoHoleAndAHoleIsOne) {
  for (const double rate_hz : {100.0, 1000.0})
    for (const double every_s : {0.0, 0.016})
      for (const double drains : {3.0, 1e6})
        for (const double hole_s : {0.0, 2.3}) {
          SCOPED_TRACE(testing::Message() << rate_hz << " Hz, every " << every_s << " s, drains at " << drains
                                          << ", hole " << hole_s);
          SampleTimes times(description(rate_hz));
          double free_s = 0.0, last_s = 0.0, longest_s = 0.0;
          std::size_t gaps = 0;
          for (int i = 0; i < 20.0 * rate_hz; ++i) {
            const double measured_s = i / rate_hz;
            const bool silent = measured_s >= 7.0 && measured_s < 9.3;
            if (silent && hole_s > 0.0) continue;
            free_s = std::max(silent ? 9.3 : measured_s, free_s + 1.0 / rate_hz / drains);
            const double came_s = every_s > 0.0 ? std::ceil(free_s / every_s) * every_s : free_s;
            const auto taken = times.next(sample(kEpoch_ns + std::llround(came_s * 1e9), i));
            ASSERT_TRUE(taken);
            gaps += i > 0 && taken->since_s - last_s > 1.5 / rate_hz ? 1 : 0;
            if (i > 0) longest_s = std::max(longest_s, taken->since_s - last_s);
            last_s = taken->since_s;
          }
          EXPECT_EQ(gaps, hole_s > 0.0 ? 1U : 0U);
          EXPECT_NEAR(last_s, 20.0 - 1.0 / rate_hz, 0.02);
          EXPECT_NEAR(longest_s, hole_s > 0.0 ? hole_s : 1.0 / rate_hz, hole_s > 0.0 ? 0.03 : 0.5 / rate_hz);
        }
}

// More or fewer than the stated rate says, each as it was measured: none is refused or has a leap before it.
TEST(SampleTimes, WhatComesAtAnotherRateThanStatedHasItsTimesOfArrival) {
  for (const double nominal_hz : {0.2, 100.0, 2000.0})
    for (const double of_it : {0.75, 0.9, 0.97, 1.03, 1.07, 1.1, 1.15, 1.17}) {
      SCOPED_TRACE(testing::Message() << nominal_hz << " Hz, really " << of_it << " of it");
      SampleTimes times(description(nominal_hz));
      const double period_s = 1.0 / (nominal_hz * of_it);
      for (int i = 0; i < 1000; ++i) {
        const auto taken = times.next(sample(kEpoch_ns + std::llround(i * period_s * 1e9), i));
        ASSERT_TRUE(taken);
        if (i > 0) {
          EXPECT_GT(taken->elapsed_s, 0.75 * period_s);
          EXPECT_LT(taken->elapsed_s, 1.3 * std::max(period_s, 1.0 / nominal_hz));
        }
        if (i >= 200) {
          EXPECT_NEAR(taken->since_s, i * period_s, 1e-6 * period_s + 2e-9);
        }
      }
    }
}

TEST(SampleTimes, WhatComesTwiceHasNoTimeAndWhatGoesBackIsRefused) {
  SampleTimes times(description(0.0));
  EXPECT_TRUE(std::isnan(times.next(sample(kEpoch_ns, 0))->elapsed_s));
  EXPECT_EQ(times.next(sample(kEpoch_ns + kStep_ns, 1))->elapsed_s, 0.01);
  EXPECT_THROW(times.next(sample(kEpoch_ns, 2)), std::runtime_error);
  times.allow_restarts();
  EXPECT_FALSE(times.next(sample(kEpoch_ns + kStep_ns, 3)));
  EXPECT_EQ(times.counts().repeated, 1U);
}

}  // namespace
}  // namespace ifog
