// SPDX-License-Identifier: Apache-2.0
// What the rooms leave out or aside: in words, behind a channel, within a dead zone.
#include <gtest/gtest.h>

#include <algorithm>
#include <cmath>
#include <cstdint>
#include <limits>
#include <numbers>
#include <stdexcept>
#include <vector>

#include "filters/diagnosis/cleaning/turned.h"
#include "filters/diagnosis/report/left_out.h"
#include "filters/diagnosis/residual/dead_zone.h"
#include "filters/diagnosis/search/earth_rate.h"
#include "tests/unit/diagnosis/gaussian_deviate.h"

namespace ifog {
namespace {

TEST(LeftOut, IsNamedByFormAndChannel) {
  Effect of_channel, of_none;
  of_channel.form = "linear";
  of_channel.channel = "supply_V";
  of_none.form = "step";
  EXPECT_EQ(
      dropped_in_words({of_channel, of_none}).find("the innovations suggest linear of supply_V, step, but "),
      0U);
  EXPECT_EQ(harmful_in_words(of_channel).find("the innovations suggest linear of supply_V, but "), 0U);
  EXPECT_EQ(judged_beside(0), "");
  EXPECT_NE(judged_beside(1).find(" 1 resonance or line that moves,"), std::string::npos);
  EXPECT_NE(judged_beside(2).find(" 2 resonances or lines that move,"), std::string::npos);
}

TEST(DeadZone, HidesWhatIsWithinItAndNothingBeyond) {
  DeadZone zone;
  zone.half_width = 2.0;
  zone.coefficient = -1.0;
  const double missing = std::numeric_limits<double>::quiet_NaN();
  const std::vector<double> rate{-3.0, -2.0, -1.5, 0.0, 1.0, 1.999, 2.0, 5.0, missing};
  const Samples hidden = hidden_by(zone, rate);
  const std::vector<double> expected{0.0, 0.0, 1.5, 0.0, -1.0, -1.999, 0.0, 0.0, 0.0};
  ASSERT_EQ(hidden.size(), expected.size());
  for (std::size_t i = 0; i < expected.size(); ++i) EXPECT_EQ(hidden[i], expected[i]) << i;
}

// The whole of it, 7.292115e-5 rad/s, when the gyro tilts by a right angle and an accelerometer along it
// loses 9.80665 m/s^2.
TEST(EarthRate, IsAtMostTheWholeOfItForG) {
  constexpr double kWhole = 7.292115e-5 / 9.80665;
  EXPECT_NEAR(largest_earth_rate("accel_x_mps2", {}), kWhole, 1e-4 * kWhole);
  EarthRateOptions along;
  along.latitude_rad = 0.8;
  EXPECT_LE(largest_earth_rate("accel_x_mps2", along), kWhole * 1.0001);
  along.axis = "x";
  EXPECT_LT(largest_earth_rate("accel_x_mps2", along), kWhole);
}

// A minute at rest, ten seconds of a turn that comes back, and rest again; or turning for 90 of 130 seconds.
struct Turned {
  std::vector<double> time, rate, reference;

  explicit Turned(bool mostly) {
    for (std::uint32_t i = 0; i < 13000; ++i) {
      time.push_back(0.01 * i);
      const bool turning = mostly ? i < 9000 : i >= 6000 && i < 7000;
      rate.push_back(1e-5 * gaussian_deviate(i, 0, 7, 11) +
                     (turning ? 0.2 * std::sin(2.0 * std::numbers::pi * 0.001 * i) : 0.0));
    }
  }
  [[nodiscard]] Record record() const {
    Record r;
    r.name = "turned.csv";
    r.time_s = time;
    r.rate_radps = rate;
    r.reference_radps = reference;
    return r;
  }
};

TEST(Turned, ItsTurnIsMissingAndItsRestAsItWas) {
  const Turned turned(false);
  const WithoutTurns rest = without_turns({turned.record()});
  ASSERT_EQ(rest.records.size(), 1U);
  ASSERT_EQ(rest.remarks.size(), 1U);
  EXPECT_EQ(rest.remarks[0].find("turned.csv: "), 0U);
  std::size_t kept = 0;
  for (std::size_t i = 0; i < turned.rate.size(); ++i) {
    const double rate = rest.records[0].rate_radps[i];
    if (std::isnan(rate)) continue;
    ++kept;
    EXPECT_EQ(rate, turned.rate[i]);
    EXPECT_FALSE(i >= 6050 && i < 6950) << i;
  }
  EXPECT_GT(kept, 9000U);
}

TEST(Turned, WithAReferenceNothingIsLeftOutAndWithLittleRestNothingIsDiagnosed) {
  Turned turned(true);
  EXPECT_THROW((void)without_turns({turned.record()}), std::invalid_argument);
  turned.reference = turned.rate;
  const WithoutTurns all = without_turns({turned.record()});
  EXPECT_EQ(all.records[0].rate_radps.data(), turned.rate.data());
  EXPECT_TRUE(all.remarks.empty());
}

// Another rate each second all along, as `allan` and `tune` tell it as well.
TEST(Turned, WhatNeverRestsIsSaid) {
  std::vector<double> time, rate;
  for (std::uint32_t i = 0; i < 13000; ++i) {
    time.push_back(0.01 * i);
    rate.push_back(0.0175 * gaussian_deviate(i / 100, 0, 7, 11) + 0.005 * gaussian_deviate(i, 0, 8, 11));
  }
  Record record;
  record.name = "moved.csv";
  record.time_s = time;
  record.rate_radps = rate;
  const WithoutTurns rest = without_turns({record});
  EXPECT_TRUE(std::any_of(rest.remarks.begin(), rest.remarks.end(), [](const std::string& remark) {
    return remark.find("moved.csv: means of 1 s scatter by") == 0 &&
           remark.find("it was never at rest, or the unit is wrong") != std::string::npos;
  }));
}

}  // namespace
}  // namespace ifog
