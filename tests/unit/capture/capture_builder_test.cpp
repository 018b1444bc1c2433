// SPDX-License-Identifier: Apache-2.0
// Samples of a driver as a capture: the devices that the chain's tests have, too
// (tests/unit/drivers/timeline_truth_test.cpp).
#include "tests/unit/capture/read_capture.h"

#include <gtest/gtest.h>

#include <cmath>
#include <numbers>

namespace ifog {
namespace {

constexpr double kRound = 2.0 * std::numbers::pi;
constexpr std::int64_t kStart_ns = 1'700'000'000'000'000'000;

// A device of 1 kHz that turns at 40 rad/s, and of which 200 samples are lost.
TEST(CaptureBuilder, OverAGapInWhichAnAngleMayHaveGoneRoundNoRateIsMadeUp) {
  for (const std::uint32_t modulus : {0U, 128U, 65536U}) {
    ifog_description d{};
    d.axes = 1;
    d.kind = IFOG_ANGLE;
    d.angle_wrap_rad = kRound;
    d.nominal_rate_hz = 1000.0;
    d.sequence_modulus = modulus;
    test::Built builder(d);
    for (int n = 0; n < 1000; ++n) {
      if (n >= 400 && n < 600) continue;
      ifog_sample sample{};
      sample.arrival_ns = kStart_ns + std::int64_t{n} * 1'000'000;
      sample.valid_axes = 1;
      sample.value[0] = std::remainder(0.04 * n, kRound);
      if (modulus != 0) {
        sample.flags = IFOG_SAMPLE_SEQUENCE;
        sample.sequence = static_cast<std::uint32_t>(n) % modulus;
      }
      builder.add(sample);
    }
    const Capture made = builder.finish();
    ASSERT_EQ(made.size(), 800U) << modulus;
    EXPECT_NEAR(made.rate_radps[0][399], 40.0, 1e-6) << modulus;
    EXPECT_TRUE(std::isnan(made.rate_radps[0][400])) << modulus;
    EXPECT_NEAR(made.rate_radps[0][401], 40.0, 1e-6) << modulus;
  }
}

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

TEST(CaptureBuilder, AClockOfMillisecondsAtFiveKilohertzLosesNoSample) {
  for (const std::uint32_t modulus : {0U, 16U}) {
    ifog_description d{};
    d.axes = 1;
    d.nominal_rate_hz = 5000.0;
    d.has_device_time = 1;
    d.sequence_modulus = modulus;
    test::Built builder(d);
    for (int n = 0; n < 20'000; ++n) {
      ifog_sample sample{};
      sample.flags = IFOG_SAMPLE_DEVICE_TIME;
      if (modulus != 0) sample.flags |= IFOG_SAMPLE_SEQUENCE;
      sample.sequence = modulus != 0 ? static_cast<std::uint32_t>(n) % modulus : 0;
      sample.device_time_ns = static_cast<std::int64_t>(n / 5) * 1'000'000;
      sample.arrival_ns = kStart_ns + std::int64_t{n} * 200'000;
      sample.valid_axes = 1;
      sample.value[0] = 1e-3 * (n % 7);
      builder.add(sample);
    }
    EXPECT_EQ(builder.counts().missing, 0U) << modulus;
    EXPECT_EQ(builder.counts().repeated, 0U) << modulus;
    const Capture made = builder.finish();
    ASSERT_EQ(made.size(), 20'000U) << modulus;
    for (std::size_t i = 1; i < made.size(); ++i) ASSERT_GT(made.time_s[i], made.time_s[i - 1]) << i;
    EXPECT_NEAR(made.time_s.back() - made.time_s.front(), 19'999 * 2e-4, 2e-3) << modulus;
  }
}

}  // namespace
}  // namespace ifog
