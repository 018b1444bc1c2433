// SPDX-License-Identifier: Apache-2.0
// A capture whose hole is long beside what was recorded is taken as two; what is short beside it is bridged.
#include "filters/diagnosis/record/long_holes.h"

#include <gtest/gtest.h>

#include <cmath>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "tests/unit/diagnosis/gaussian_deviate.h"

namespace ifog {
namespace {

constexpr std::uint32_t kSamples = 12000;
constexpr double kStep_s = 0.1;

struct Capture {
  std::vector<double> time, rate, temperature;
  [[nodiscard]] Record record() const {
    Record r;
    r.name = "sensor";
    r.time_s = time;
    r.rate_radps = rate;
    r.channels = {{"temperature_degC", temperature}};
    return r;
  }
};

// Twenty minutes at 10 Hz with a hole behind row 6000 and a bias that follows the temperature.
Capture with_hole(double hole_s) {
  Capture c;
  for (std::uint32_t i = 0; i < kSamples; ++i) {
    const double t = kStep_s * i + (i > 6000 ? hole_s : 0.0);
    c.time.push_back(t);
    c.temperature.push_back(25.0 + 6.0 * std::sin(2.0 * M_PI * t / 411.0) +
                            0.004 * gaussian_deviate(i, 1, 13, 9));
    c.rate.push_back(1e-7 * (c.temperature.back() - 25.0) + 1e-6 * gaussian_deviate(i, 2, 13, 9));
  }
  return c;
}

TEST(LongHoles, PartAndShortOnesDoNot) {
  const Capture parted = with_hole(40.0 * 3600.0);
  const PartedRecords two = part_at_long_holes({parted.record()});
  ASSERT_EQ(two.records.size(), 2U);
  EXPECT_EQ(two.records[0].time_s.size(), 6001U);
  EXPECT_EQ(two.records[1].time_s.size(), 5999U);
  EXPECT_EQ(two.records[1].channels[0].values.data(), parted.temperature.data() + 6001);
  EXPECT_EQ(two.records[1].name, "sensor (from 144600.1 s)");
  ASSERT_EQ(two.remarks.size(), 1U);
  const Capture whole = with_hole(200.0);
  const PartedRecords one = part_at_long_holes({whole.record()});
  ASSERT_EQ(one.records.size(), 1U);
  EXPECT_EQ(one.records[0].time_s.size(), whole.time.size());
  EXPECT_TRUE(one.remarks.empty());
}

TEST(LongHoles, AFewRowsBesideOneAreLeftOutAndItIsSaid) {
  Capture c = with_hole(0.0);
  for (std::uint32_t i = kSamples - 50; i < kSamples; ++i) c.time[i] += 86400.0;
  const PartedRecords parted = part_at_long_holes({c.record()});
  ASSERT_EQ(parted.records.size(), 1U);
  EXPECT_EQ(parted.records[0].time_s.size(), kSamples - 50U);
  ASSERT_EQ(parted.remarks.size(), 1U);
  EXPECT_NE(parted.remarks[0].find("50 rows"), std::string::npos) << parted.remarks[0];
}

TEST(LongHoles, ADayWithoutRowsHidesNoEffect) {
  const Diagnosis found = diagnose({with_hole(40.0 * 3600.0).record()}, {});
  ASSERT_EQ(found.effects.size(), 1U);
  const Effect& effect = found.effects[0].effect;
  EXPECT_EQ(effect.form + effect.channel, "lineartemperature_degC");
  EXPECT_NEAR(effect.parameters[0].value, 1e-7, 4.0 * effect.parameters[0].std_error);
}

}  // namespace
}  // namespace ifog
