// SPDX-License-Identifier: Apache-2.0
// What loggers do to a channel is undone, and what only looks like it is left alone.
#include "filters/diagnosis/cleaning/steps.h"

#include <gtest/gtest.h>

#include <cmath>
#include <random>

#include "filters/diagnosis/record/blocks.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"

namespace ifog {
namespace {

constexpr std::size_t kSamples = 4000;

struct Logged {
  std::vector<double> time, rate = std::vector<double>(kSamples, 0.0), channel;

  Logged() {
    for (std::size_t i = 0; i < kSamples; ++i) time.push_back(static_cast<double>(i));
  }
  template <class Value>
  explicit Logged(Value&& value) : Logged() {
    for (std::size_t i = 0; i < kSamples; ++i) channel.push_back(value(static_cast<double>(i)));
  }
  [[nodiscard]] Record record(const char* name) const {
    return made_record("logged", time, rate, {{name, channel}});
  }
  [[nodiscard]] OwnedRecords repaired(const char* name) const {
    return repair_channels(std::vector{record(name)});
  }
  [[nodiscard]] OwnedRecords without_leaps_of_rate() const {
    return without_leaping_rates(std::vector{record("supply_V")});
  }
};

// Hundredths of a degree, as a thermometer gives them.
double warming(double t) { return std::round(100.0 * (20.0 + 15.0 * std::sin(t / 900.0))) / 100.0; }

TEST(ChannelFaults, WhatAThermometerCannotHaveMeasuredIsInterpolated) {
  Logged logged(warming);
  for (std::size_t i = 1000; i < 1050; ++i) logged.channel[i] = 85.0;
  for (std::size_t i = 2500; i < 2503; ++i) logged.channel[i] = -127.0;
  const OwnedRecords repaired = logged.repaired("temperature_degC");
  for (std::size_t i = 0; i < kSamples; ++i)
    EXPECT_NEAR(repaired.records[0].channels[0].values[i], warming(static_cast<double>(i)), 0.02) << i;
  ASSERT_EQ(repaired.remarks.size(), 1U);
  EXPECT_NE(repaired.remarks[0].find("temperature_degC leaps away and back 2 time(s), for 53 sample(s)"),
            std::string::npos)
      << repaired.remarks[0];
}

// For a tenth of the record, which no excursion of a real vibration does: there is one number in it.
TEST(ChannelFaults, ANumberInPlaceOfAVibrationIsNoneHoweverOftenItStands) {
  std::mt19937_64 random(9);
  std::normal_distribution<double> noise(0.0, 4.0);
  Logged logged([&](double) { return noise(random); });
  const std::vector<double> before = logged.channel;
  for (std::size_t start = 500; start < 3500; start += 600)
    for (std::size_t i = start; i < start + 55; ++i) logged.channel[i] = -999.0;
  std::fill_n(logged.channel.begin() + 3600, 90, -999.0);  // longer than anything is interpolated over
  const OwnedRecords repaired = logged.repaired("accel_x_mps2");
  const auto values = repaired.records[0].channels[0].values;
  for (std::size_t i = 0; i < kSamples; ++i) {
    EXPECT_EQ(std::isnan(values[i]), i >= 3600 && i < 3690) << i;
    EXPECT_FALSE(std::abs(values[i]) > 25.0) << i;
    EXPECT_TRUE(logged.channel[i] == -999.0 || values[i] == before[i]) << i;
  }
}

TEST(ChannelFaults, WhatOnlyLooksLikeOneIsLeftAlone) {
  std::mt19937_64 random(5);
  std::normal_distribution<double> normal;
  const auto untouched = [](const Logged& logged, const char* name) {
    const OwnedRecords repaired = logged.repaired(name);
    EXPECT_TRUE(repaired.remarks.empty()) << name << ": " << repaired.remarks.front();
    EXPECT_EQ(repaired.records[0].channels[0].values.data(), logged.channel.data());
  };
  untouched(Logged(warming), "temperature_degC");
  Logged blow([&](double) { return 9.81 + 0.01 * normal(random); });
  blow.channel[2000] = 10.0;  // nineteen of its standard deviations
  untouched(blow, "accel_z_mps2");
  untouched(Logged([](double t) { return t > 1000.0 && t < 1030.0 ? 1.0 : 0.0; }), "heater_on");
  // Full scale of the converter, for a fifth of the record; and a load that is off for longer than a minute
  // now and then.
  untouched(Logged([&](double t) { return std::fmod(t, 800.0) < 640.0 ? 1.0 + 0.01 * normal(random) : 5.0; }),
            "valve_V");
  untouched(Logged([&](double t) { return std::fmod(t, 1800.0) < 1730.0 ? 250.0 + normal(random) : 0.0; }),
            "heater_mA");
  // A supply that another consumer pulls down for good: a step, and no return.
  untouched(Logged([&](double t) { return (t < 2000.0 ? 12.0 : 11.2) + 0.01 * std::sin(t / 300.0); }),
            "supply_V");
  // A thermometer in whole degrees stands still by its resolution and moves by its usual change.
  untouched(Logged([](double t) { return std::round(20.0 + 15.0 * std::sin(t / 900.0)); }), "coil_degC");
}

// A value is judged by the one before it, however long ago that was: an empty cell next to a glitch hides
// nothing, nor does a thermometer that is polled every ten seconds, or a record that begins or ends in one.
TEST(ChannelFaults, EmptyCellsDoNotHideAGlitch) {
  for (const std::size_t at : {std::size_t{0}, std::size_t{2000}, kSamples - 10}) {
    Logged logged(warming);
    for (std::size_t i = 0; i < kSamples; ++i)
      if (i % 10 != 0) logged.channel[i] = std::nan("");
    logged.channel[at] = -1e6;
    const OwnedRecords repaired = logged.repaired("temperature_degC");
    ASSERT_EQ(repaired.remarks.size(), 1U) << at;
    for (std::size_t i = 0; i < kSamples; ++i) {
      const double value = repaired.records[0].channels[0].values[i];
      ASSERT_EQ(std::isfinite(value), i % 10 == 0) << i;
      if (i % 10 == 0) {
        EXPECT_NEAR(value, warming(static_cast<double>(i)), 0.2) << i;
      }
    }
  }
}

TEST(ChannelFaults, ASampleOfTheRateThatLeapsIsBetweenItsNeighbours) {
  std::mt19937_64 random(6);
  std::normal_distribution<double> normal;
  Logged logged(warming);
  for (double& rate : logged.rate) rate = 1e-6 * normal(random);
  logged.rate[1700] = 5e-4;  // a hundred times what the others span
  const auto clean = logged.rate;
  const OwnedRecords repaired = logged.without_leaps_of_rate();
  for (std::size_t i = 0; i < kSamples; ++i) {
    const double rate = repaired.records[0].rate_radps[i];
    if (i == 1700)
      EXPECT_NEAR(rate, 0.5 * (clean[i - 1] + clean[i + 1]), 1e-18);
    else
      EXPECT_EQ(rate, clean[i]);
  }
  ASSERT_EQ(repaired.remarks.size(), 1U);
  EXPECT_NE(repaired.remarks[0].find("1 sample leaps away and back"), std::string::npos)
      << repaired.remarks[0];
  // A knock of ten samples and one of twenty sigma are the sensor's own.
  logged.rate[1700] = 2e-5;
  for (std::size_t i = 3000; i < 3010; ++i) logged.rate[i] = 5e-4;
  EXPECT_TRUE(logged.without_leaps_of_rate().remarks.empty());
}

// Where rows are missing for 300 s the channel is a straight line: no step for a derivative to see.
TEST(ChannelFaults, AHoleInTheRowsIsBridged) {
  std::vector<double> time, rate, channel;
  for (std::size_t i = 0; i < 4000; ++i) {
    if (i >= 1000 && i < 1300) continue;
    time.push_back(static_cast<double>(i));
    rate.push_back(0.0);
    channel.push_back(0.01 * static_cast<double>(i));
  }
  Record record;
  record.name = "with a hole";
  record.time_s = time;
  record.rate_radps = rate;
  record.channels = {{"temperature_degC", channel}};
  const BlockData data = cut_to_blocks({record});
  ASSERT_EQ(data.grid.fine, 1U);
  for (std::size_t k = 0; k < 4000; ++k)
    EXPECT_NEAR(data.channels[0].values[k], 0.01 * static_cast<double>(k), 1e-9) << k;
  EXPECT_EQ(data.grid.valid[1100], 0);
}

}  // namespace
}  // namespace ifog
