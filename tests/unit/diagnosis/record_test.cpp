// SPDX-License-Identifier: Apache-2.0
// The room `record`: what a capture is before anything is fitted to it.
#include "filters/diagnosis/cleaning/prepared_records.h"
#include "filters/diagnosis/cleaning/steps.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/figures.h"
#include "tests/unit/diagnosis/blocks_by_hand.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

const double kNan = std::numeric_limits<double>::quiet_NaN();

struct Arrays {
  std::vector<double> time, rate, temperature;

  explicit Arrays(std::size_t n) {
    for (std::size_t i = 0; i < n; ++i) {
      time.push_back(0.125 * static_cast<double>(i));  // exact, so that blocks are
      rate.push_back(static_cast<double>(i));
      temperature.push_back(25.0 + 0.1 * static_cast<double>(i));
    }
  }
  [[nodiscard]] Record record() const {
    return made_record("by hand", time, rate, {{"temperature_degC", temperature}});
  }
};

// 1000 samples in at most 100 blocks: ten samples each, whose mean of a straight line is its middle.
TEST(Blocks, AreMeansOverEqualTimes) {
  const Arrays arrays(1000);
  const BlockData data = cut_to_blocks({arrays.record()}, 100);
  ASSERT_EQ(data.grid.size(), 100U);
  EXPECT_DOUBLE_EQ(data.grid.block_s, 1.25);
  for (Eigen::Index b = 0; b < 100; ++b) EXPECT_NEAR(data.grid.error[b], 10.0 * double(b) + 4.5, 1e-9);
  // Linear in the channel about 25 °C: the same mean, a tenth as large.
  ShapeSettings linear;
  linear.form = Form::kLinear;
  linear.reference = 25.0;
  const Eigen::VectorXd means = column(data, linear, 0);
  for (Eigen::Index b = 0; b < 100; ++b) EXPECT_NEAR(means[b], double(b) + 0.45, 1e-9);
}

// In whole milliseconds most steps of 128 Hz are 8 ms, and of 150 Hz 7 ms: no sample took so long.
TEST(Blocks, AreOfTheTrueRateWhereStampsAreRounded) {
  for (const double hertz : {128.0, 150.0, 100.0, 333.3}) {
    Arrays arrays(20000);
    for (std::size_t i = 0; i < arrays.time.size(); ++i)
      arrays.time[i] = 1e-3 * std::round(1e3 * static_cast<double>(i) / hertz);
    EXPECT_NEAR(cut_to_blocks({arrays.record()}).grid.sample_s * hertz, 1.0, 1e-5) << hertz;
  }
}

// A rate table between two set rates: a step in which it reverses has the mean of both, as the gyro's rate has. A thermometer
// of two values keeps its levels.
TEST(Blocks, OnlyAThermometerKeepsItsLevels) {
  Arrays made(4000);
  std::vector<double> reference, coarse;
  for (std::size_t i = 0; i < made.time.size(); ++i) {
    reference.push_back(i / 101 % 2 == 0 ? 0.1 : -0.1);
    coarse.push_back(i / 103 % 2 == 0 ? 25.0 : 26.0);
  }
  const BlockData data = cut_to_blocks(
      {made_record("table", made.time, made.rate, {{"temperature_degC", coarse}}, reference)}, 64);
  const auto between = [](const FineChannel& channel, double low, double high) {
    return std::ranges::any_of(channel.values, [&](double v) { return v > low + 1e-9 && v < high - 1e-9; });
  };
  EXPECT_TRUE(between(data.channels[static_cast<std::size_t>(data.reference)], -0.1, 0.1));
  EXPECT_FALSE(between(data.channels[0], 25.0, 26.0));
}

// A day between two minutes, or two of three cells empty: what there is too little of is said.
TEST(Blocks, TooFewOfThemAreSaid) {
  Arrays hole(1000), empty(6000);
  for (std::size_t i = 500; i < 1000; ++i) hole.time[i] += 86400.0;
  for (std::size_t i = 0; i < 6000; ++i)
    if (i % 3 != 0) empty.rate[i] = kNan;
  for (const auto& [arrays, samples] :
       {std::pair{&hole, "1000 samples"}, std::pair{&empty, "2000 samples"}}) {
    const std::string said =
        test::refusal([&] { static_cast<void>(cut_to_blocks({arrays->record()}, 100)); }, "was cut");
    for (const char* part : {samples, "at least 32", "--from", "empty cells"})
      EXPECT_TRUE(test::has(said, part)) << part << ": " << said;
  }
  EXPECT_THROW(static_cast<void>(cut_to_blocks({Arrays(20).record()}, 100)), std::invalid_argument);
}

TEST(Blocks, OfSeveralRecordsFollowEachOtherAndAGapIsNotValid) {
  Arrays first(600);
  const Arrays second(400);
  for (std::size_t i = 200; i < 260; ++i) first.rate[i] = kNan;
  const BlockData data = cut_to_blocks({first.record(), second.record()}, 100);
  const BlockGrid& grid = data.grid;
  ASSERT_EQ(grid.records.size(), 2U);
  EXPECT_EQ(grid.records[0].first, 0U);
  EXPECT_EQ(grid.records[0].end, grid.records[1].first);
  EXPECT_EQ(grid.records[1].end, grid.size());
  EXPECT_EQ(grid.longest(), 60U);
  EXPECT_EQ(grid.constants(), 2);
  EXPECT_EQ(grid.fine_steps(grid.records[1]).size(), 40U * grid.fine);
  EXPECT_EQ(grid.used(), 94U);
  for (std::size_t b = 20; b < 26; ++b) EXPECT_EQ(grid.valid[b], 0);
}

TEST(PreparedRecords, AreRepairedAndCutAndSayWhatWasDone) {
  Arrays arrays(4000);
  test::Noise normal(11);
  for (double& rate : arrays.rate) rate = 1e-6 * normal();
  arrays.rate[500] = 1e-3;  // a knock
  for (std::size_t i = 0; i < 4000; ++i) arrays.temperature[i] = 25.0 + 1e-3 * static_cast<double>(i);
  arrays.temperature[1000] = 85.0;  // a thermometer's power-on value
  const std::vector<Record> captures = {arrays.record()};
  const PreparedRecords prepared(captures, {0.0, 0.5});
  const Record& whole = prepared.whole.records.front();
  EXPECT_NEAR(whole.rate_radps[500], 0.5 * (arrays.rate[499] + arrays.rate[501]), 1e-18);
  EXPECT_EQ(whole.rate_radps[501], arrays.rate[501]);
  EXPECT_NEAR(values_of(whole, "temperature_degC")[1000], 26.0, 1e-9);
  EXPECT_EQ(prepared.fitted.front().time_s.size(), 2000U);
  EXPECT_EQ(prepared.fitted.front().rate_radps.data(), whole.rate_radps.data());
  ASSERT_EQ(prepared.without_ramps.records.size(), 1U);
  ASSERT_EQ(prepared.whole.remarks.size(), 2U);
  EXPECT_TRUE(test::has(prepared.whole.remarks[1], "1 sample leaps away"));
  EXPECT_TRUE(test::has(prepared.whole.remarks[0], "temperature_degC leaps away"));
}

TEST(PreparedRecords, NothingIsRepairedWhereNothingIsWrong) {
  Arrays arrays(400);
  test::Noise normal(12);
  for (double& rate : arrays.rate) rate = 1e-6 * normal();
  const std::vector<Record> captures = {arrays.record()};
  const PreparedRecords prepared(captures);
  EXPECT_TRUE(prepared.whole.remarks.empty());
  EXPECT_EQ(prepared.fitted.front().rate_radps.data(), arrays.rate.data());
  Record backwards = arrays.record();
  arrays.time[7] = arrays.time[5];
  EXPECT_THROW(PreparedRecords({backwards}), std::invalid_argument);
}

// What loggers do to a channel is undone, and what only looks like it is left alone.

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
  EXPECT_TRUE(
      test::has(repaired.remarks[0], "temperature_degC leaps away and back 2 time(s), for 53 sample(s)"));
}

// For a tenth of the record, which no excursion of a real vibration does: there is one number in it.
TEST(ChannelFaults, ANumberInPlaceOfAVibrationIsNoneHoweverOftenItStands) {
  test::Noise noise(9, 4.0);
  Logged logged([&](double) { return noise(); });
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
  test::Noise normal(5);
  const auto untouched = [](const Logged& logged, const char* name) {
    const OwnedRecords repaired = logged.repaired(name);
    EXPECT_TRUE(repaired.remarks.empty()) << name << ": " << repaired.remarks.front();
    EXPECT_EQ(repaired.records[0].channels[0].values.data(), logged.channel.data());
  };
  untouched(Logged(warming), "temperature_degC");
  Logged blow([&](double) { return 9.81 + 0.01 * normal(); });
  blow.channel[2000] = 10.0;  // nineteen of its standard deviations
  untouched(blow, "accel_z_mps2");
  untouched(Logged([](double t) { return t > 1000.0 && t < 1030.0 ? 1.0 : 0.0; }), "heater_on");
  // Full scale of the converter, for a fifth of the record; and a load that is off for longer than a minute
  // now and then.
  untouched(Logged([&](double t) { return std::fmod(t, 800.0) < 640.0 ? 1.0 + 0.01 * normal() : 5.0; }),
            "valve_V");
  untouched(Logged([&](double t) { return std::fmod(t, 1800.0) < 1730.0 ? 250.0 + normal() : 0.0; }),
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
  test::Noise normal(6);
  Logged logged(warming);
  for (double& rate : logged.rate) rate = 1e-6 * normal();
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
  EXPECT_TRUE(test::has(repaired.remarks[0], "1 sample leaps away and back"));
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
  const BlockData data =
      cut_to_blocks({made_record("with a hole", time, rate, {{"temperature_degC", channel}})});
  ASSERT_EQ(data.grid.fine, 1U);
  for (std::size_t k = 0; k < 4000; ++k)
    EXPECT_NEAR(data.channels[0].values[k], 0.01 * static_cast<double>(k), 1e-9) << k;
  EXPECT_EQ(data.grid.valid[1100], 0);
}

}  // namespace
}  // namespace ifog
