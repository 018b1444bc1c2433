// SPDX-License-Identifier: Apache-2.0
// The driver that takes a CSV capture for a sensor: the same numbers as read_capture gives, from bytes in any
// portions.
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace {

using ifog::decoded;

TEST(CaptureDriver, TimesOfTheEpochKeepTheirNanoseconds) {
  ifog::DriverInstance driver = ifog::make_driver("capture", {});
  const std::vector<ifog_sample> samples =
      decoded(driver,
              "time_s,rate_radps\n-1700000000.000000001,1\n-0.25,1\n.5,1\n1.5e0,1\n1700000000.1234567895,1\n"
              "1700000000.133456789,1\n8999999998.999999999,1\n",
              1000);
  std::vector<std::int64_t> times;
  for (const ifog_sample& sample : samples) times.push_back(sample.device_time_ns);
  EXPECT_EQ(times, (std::vector<std::int64_t>{-1'700'000'000'000'000'001, -250'000'000, 500'000'000,
                                              1'500'000'000, 1'700'000'000'123'456'790,
                                              1'700'000'000'133'456'789, 8'999'999'998'999'999'999}));
}

TEST(CaptureDriver, RowsBecomeSamplesInAnyPortions) {
  const std::string text =
      "# a gyro\n\ntime_s,rate_x_radps,supply_V,rate_y_radps,temperature_degC\r\n"
      "-0.5,1e-3,12,-2.5,25.5\r\n0,,12,+4,\n0.0050000001,nan,12, 0.1 ,26\n";
  for (const std::size_t portion : {1U, 2U, 7U, 1000U}) {
    ifog::DriverInstance driver = ifog::make_driver(
        "capture", {{"columns", "rate_y_radps, temperature_degC,rate_x_radps"}, {"rate_hz", "200"}});
    const ifog_description& d = driver.description();
    EXPECT_EQ(d.axes, 2U);
    EXPECT_STREQ(d.axis[0], "y");
    EXPECT_STREQ(d.axis[1], "x");
    EXPECT_EQ(d.environments, 1U);
    EXPECT_STREQ(d.environment[0], "temperature_degC");
    EXPECT_EQ(d.nominal_rate_hz, 200.0);
    const std::vector<ifog_sample> samples = decoded(driver, text, portion);
    ASSERT_EQ(samples.size(), 3U);
    EXPECT_EQ(samples[0].device_time_ns, -500'000'000);
    EXPECT_EQ(samples[0].arrival_ns, 42);
    EXPECT_EQ(samples[0].value[0], -2.5);
    EXPECT_EQ(samples[0].value[1], 1e-3);
    EXPECT_EQ(samples[0].environment[0], 25.5);
    EXPECT_EQ(samples[0].valid_axes, 3U);
    EXPECT_EQ(samples[0].environment_fresh, 1U);
    EXPECT_EQ(samples[1].value[0], 4.0);
    EXPECT_EQ(samples[1].valid_axes, 1U);
    EXPECT_EQ(samples[1].environment[0], 25.5);  // the last known
    EXPECT_EQ(samples[1].environment_fresh, 0U);
    EXPECT_EQ(samples[2].device_time_ns, 5'000'000);
    EXPECT_TRUE(std::isnan(samples[2].value[1]));
    EXPECT_EQ(samples[2].environment[0], 26.0);
    EXPECT_EQ(driver.counters().frames_good, 3U);
    EXPECT_EQ(driver.counters().frames_format, 0U);
    EXPECT_EQ(driver.counters().bytes_skipped, 0U);
  }
}

TEST(CaptureDriver, WhatIsNoRowIsCountedAndPassedOver) {
  ifog::DriverInstance driver = ifog::make_driver("capture", {});
  const std::string text =
      "time_s,rate_radps\n0,1\n0,2\n1\n1,2,3\n1,two\n1,inf\n,5\n" + std::string(40'000, 'x') + "\n1,6\n2,7";
  const std::vector<ifog_sample> samples = decoded(driver, text, 100);
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[1].value[0], 6.0);
  EXPECT_EQ(driver.counters().frames_good, 2U);
  EXPECT_EQ(driver.counters().frames_format, 7U);
  const std::uint64_t skipped = driver.counters().bytes_skipped;
  EXPECT_GE(skipped, 40'000U);
  // The capture was cut off within its last line.
  driver.reset();
  EXPECT_EQ(driver.counters().bytes_skipped, skipped + 3);
  // What follows is another capture, whose time may start again.
  EXPECT_EQ(decoded(driver, "time_s,rate_radps\n0,1\n", 5).size(), 1U);
}

TEST(CaptureDriver, AHeaderWithoutTheWantedColumnsGivesNoSamples) {
  ifog::DriverInstance driver = ifog::make_driver("capture", {{"columns", "rate_radps,temperature_degC"}});
  const std::vector<ifog_sample> samples = decoded(driver, "time_s,rate_radps\n0,1\n", 5);
  EXPECT_TRUE(samples.empty());
  EXPECT_EQ(driver.counters().frames_format, 2U);
  EXPECT_TRUE(decoded(driver, "time_s,rate_radps,rate_radps\n0,1,1\n", 5).empty());
}

TEST(CaptureDriver, RefusesColumnsThatCannotBe) {
  const auto refusal = [](const std::string& columns) {
    const std::string line = ifog::refusal("capture", {{"columns", columns}});
    return line.substr(line.find("columns is"));
  };
  EXPECT_EQ(refusal("temperature_degC"),
            "columns is 'temperature_degC', expected 1 to 3 rate columns, rate_radps or rate_x_radps, …");
  EXPECT_EQ(refusal("rate_radps,"),
            "columns is 'rate_radps,', expected names of 1 to 47 letters between commas, without time_s");
  EXPECT_EQ(refusal("rate_x_radps,rate_x_radps"),
            "columns is 'rate_x_radps,rate_x_radps', expected each name once");
}

}  // namespace
