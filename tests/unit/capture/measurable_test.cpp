// SPDX-License-Identifier: Apache-2.0
// One cell that no sensor can have measured is missing; it neither refuses the capture nor stays in it.
#include "drivers/capture/columns/measurable.h"

#include <gtest/gtest.h>

#include <cmath>

#include "tests/unit/capture/read_capture.h"

namespace ifog {
namespace {

// 200 rows at 10 Hz; `cell` stands in the row and column given.
std::string capture(const char* columns, int width, int row, int column, const std::string& cell) {
  std::string text = std::string("time_s,") + columns + "\n";
  for (int i = 0; i < 200; ++i) {
    text += std::to_string(0.1 * i);
    for (int c = 0; c < width; ++c)
      text += "," + (i == row && c == column ? cell : std::to_string(1e-3 * (i % 7)));
    text += "\n";
  }
  return text;
}

TEST(Measurable, OneImpossibleCellIsMissingAndTold) {
  struct Case {
    const char* columns;
    const char* cell;
  };
  for (const Case& each :
       {Case{"rate_radps,accel_x_mps2", "1e30"}, Case{"rate_radps,accel_x_mps2", "-1e6"},
        Case{"rate_radps,temperature_degC", "-999"}, Case{"rate_radps,temperature_degC", "9999"},
        Case{"rate_radps,case_degF", "-500"}, Case{"rate_radps,temperature_K", "-1"},
        Case{"rate_radps,ramp_counts", "1e21"}, Case{"rate_radps,rate_y_radps", "-1e30"},
        Case{"rate_radps,reference_rate_radps", "20000"}}) {
    InputFile file("a.csv", capture(each.columns, 2, 100, 1, each.cell));
    const Table table = read_table(file);
    EXPECT_TRUE(std::isnan(table.columns[1].values[100])) << each.columns << each.cell;
    EXPECT_FALSE(std::isnan(table.columns[1].values[99]));
    ASSERT_EQ(table.faults.size(), 1U) << each.columns << each.cell;
    EXPECT_EQ(table.faults[0].substr(0, 11), "a.csv:102: ") << table.faults[0];
    EXPECT_NE(table.faults[0].find("1 such cell treated as missing"), std::string::npos);
  }
  const Capture read = parse_capture(capture("rate_radps,accel_x_mps2", 2, 3, 0, "1e30"), "a.csv");
  EXPECT_TRUE(std::isnan(read.rate_radps[0][3]));
  EXPECT_EQ(read.faults.size(), 1U);
}

// What a sensor may well say stays, however odd.
TEST(Measurable, WhatMayBeMeasuredStays) {
  for (const char* const cell : {"85", "-127", "-273.15", "1200"}) {
    const Capture read = parse_capture(capture("rate_radps,temperature_degC", 2, 50, 1, cell), "a.csv");
    EXPECT_EQ(read.channels[0].values[50], std::stod(cell));
    EXPECT_TRUE(read.faults.empty());
  }
}

// The limit is that of the unit in the file: 5000 °F are 2760 °C.
TEST(Measurable, LimitsAreConvertedWithTheColumn) {
  CsvLayout layout;
  layout.columns = {CsvColumn::parse("rate_radps=w:rad/s"), CsvColumn::parse("temperature_degC=T:degF")};
  layout.time = CsvTime::parse("time_s:s");
  EXPECT_NEAR(parse_capture(capture("w,T", 2, 9, 1, "5000"), "a.csv", layout).channels[0].values[9], 2760.0,
              1e-9);
  EXPECT_TRUE(
      std::isnan(parse_capture(capture("w,T", 2, 9, 1, "9000"), "a.csv", layout).channels[0].values[9]));
}

// Names that end in a letter that a unit has, too: no limit but the interface's.
TEST(Measurable, ALetterIsNoUnit) {
  for (const char* const column : {"k", "gps_t", "gps_T", "adc_c", "encoder_A", "position_k", "phase_c"}) {
    EXPECT_TRUE(measurable(column).holds(1.7e9)) << column;
    EXPECT_TRUE(measurable(column).holds(-1e6 - 1.0)) << column;
  }
  EXPECT_FALSE(measurable("case_temperature_K").holds(-1.0));
  EXPECT_FALSE(measurable("supply_V").holds(1e7));
  EXPECT_FALSE(measurable("x_accel_g").holds(1e7));
}

// A thermometer that says -999 every other row tells nothing; the rate does.
TEST(Measurable, AChannelOfThemIsMissingAndNoReasonToRefuse) {
  std::string text = "time_s,rate_radps,temperature_degC\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(i) + (i % 2 == 1 ? ",0,-999\n" : ",0,25\n");
  const Capture read = parse_capture(text, "a.csv");
  EXPECT_TRUE(std::isnan(read.channels[0].values[1]));
  EXPECT_EQ(read.channels[0].values[2], 25.0);
  ASSERT_EQ(read.faults.size(), 1U);
  EXPECT_NE(read.faults[0].find("50 such cells treated as missing"), std::string::npos) << read.faults[0];
}

TEST(Measurable, AColumnOfThemIsRefusedAndSoIsWhatIsNoNumber) {
  std::string text = "time_s,rate_radps\n";
  for (int i = 0; i < 100; ++i) text += std::to_string(i) + (i % 20 == 7 ? ",1e30\n" : ",0\n");
  EXPECT_EQ(
      refusal_of(text),
      "a.csv:9: rate_radps is '1e30', which no sensor measures, expected -10000 to 10000; nor 4 more of "
      "its cells");
  for (const std::string word : {"inf", "-inf", "1e999"})
    EXPECT_EQ(refusal_of("time_s,rate_radps\n0,1\n1,1\n2," + word + "\n3," + word + "\n"),
              "a.csv:4: rate_radps is '" + word +
                  "', which no sensor measures, expected -10000 to 10000; nor 1 more of its cells");
  // A time is not to be guessed.
  EXPECT_EQ(refusal_of("time_s,rate_radps\n0,1\n1e30,1\n").substr(0, 49),
            "a.csv:3: time_s is '1e30', which no sensor measur");
}

}  // namespace
}  // namespace ifog
