// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/sample_times.h"

#include <gtest/gtest.h>

#include <cmath>
#include <stdexcept>

namespace {

using ifog::SampleTimes;
using ifog::TimeOrigin;

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

TEST(SampleTimes, SmallStampsStandAsTheyAreAndZeroIsOne) {
  for (const std::int64_t zero_ns : {std::int64_t{0}, std::int64_t{1'000'000'000}})
    for (const std::int64_t start_s : {0, 50}) {
      SampleTimes times(description(0.0));
      times.keep_stamps(zero_ns);
      for (int i = 0; i < 100; ++i)
        EXPECT_EQ(times.next(sample(zero_ns + start_s * 1'000'000'000 + kStep_ns * i, i))->since_s,
                  static_cast<double>(start_s * 100 + i) / 100.0);
      EXPECT_EQ(times.origin(), TimeOrigin{});
    }
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

TEST(SampleTimes, WhatComesTwiceHasNoTimeAndWhatGoesBackIsRefused) {
  SampleTimes times(description(0.0));
  EXPECT_TRUE(std::isnan(times.next(sample(kEpoch_ns, 0))->elapsed_s));
  EXPECT_EQ(times.next(sample(kEpoch_ns + kStep_ns, 1))->elapsed_s, 0.01);
  EXPECT_THROW(times.next(sample(kEpoch_ns, 2)), std::runtime_error);
  times.allow_restarts();
  EXPECT_FALSE(times.next(sample(kEpoch_ns + kStep_ns, 3)));
  EXPECT_EQ(times.repeated(), 1U);
}

}  // namespace
