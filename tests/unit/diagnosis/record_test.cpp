// SPDX-License-Identifier: Apache-2.0
// The room `record`: what a capture is before anything is fitted to it.
#include <gtest/gtest.h>

#include <cmath>
#include <limits>
#include <random>
#include <stdexcept>
#include <string>

#include "filters/diagnosis/cleaning/prepared_records.h"
#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/figures.h"
#include "tests/unit/diagnosis/made_capture.h"
#include "tests/unit/refusal.h"

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
      EXPECT_NE(said.find(part), std::string::npos) << part << ": " << said;
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
  std::mt19937_64 draw(11);
  std::normal_distribution<double> normal;
  for (double& rate : arrays.rate) rate = 1e-6 * normal(draw);
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
  EXPECT_NE(prepared.whole.remarks[1].find("1 sample leaps away"), std::string::npos)
      << prepared.whole.remarks[1];
  EXPECT_NE(prepared.whole.remarks[0].find("temperature_degC leaps away"), std::string::npos);
}

TEST(PreparedRecords, NothingIsRepairedWhereNothingIsWrong) {
  Arrays arrays(400);
  std::mt19937_64 draw(12);
  std::normal_distribution<double> normal;
  for (double& rate : arrays.rate) rate = 1e-6 * normal(draw);
  const std::vector<Record> captures = {arrays.record()};
  const PreparedRecords prepared(captures);
  EXPECT_TRUE(prepared.whole.remarks.empty());
  EXPECT_EQ(prepared.fitted.front().rate_radps.data(), arrays.rate.data());
  Record backwards = arrays.record();
  arrays.time[7] = arrays.time[5];
  EXPECT_THROW(PreparedRecords({backwards}), std::invalid_argument);
}

}  // namespace
}  // namespace ifog
