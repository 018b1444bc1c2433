// SPDX-License-Identifier: Apache-2.0
#include "drivers/capture/times/date_time.h"

#include <gtest/gtest.h>

#include <string>

#include "drivers/capture/capture.h"
#include "tests/unit/capture/refusal.h"

namespace {

using ifog::Capture;
using ifog::CsvLayout;
using ifog::parse_capture;

std::string seconds(const std::string& text) {
  std::array<char, ifog::kLongestDate> to{};
  return std::string(ifog::date_in_digits(text, to));
}

// Oracle: `date -u -d … +%s`.
TEST(DateTime, SecondsSince1970WithEveryDigit) {
  EXPECT_EQ(seconds("2026-05-01T12:00:00Z"), "1777636800");
  EXPECT_EQ(seconds("2026-05-01 12:00:00"), "1777636800");
  EXPECT_EQ(seconds("2026/05/01 12:00"), "1777636800");
  EXPECT_EQ(seconds("2026_05_01_12_00_00.25"), "1777636800.25");
  EXPECT_EQ(seconds("2026-05-01"), "1777593600");
  EXPECT_EQ(seconds("2026-05-01T12:00:00.123456789012Z"), "1777636800.123456789012");
  EXPECT_EQ(seconds("2026-05-01t12:00:00,5z"), "1777636800.5");
  EXPECT_EQ(seconds("2026-05-01T12:00:00.250+02:00"), "1777629600.250");
  EXPECT_EQ(seconds("2026-05-01T12:00:00-0530"), "1777656600");
  EXPECT_EQ(seconds("2026-05-01T12:00:00+02"), "1777629600");
  EXPECT_EQ(seconds("2026-05-01 12:00:00 UTC"), "1777636800");
  EXPECT_EQ(seconds("2024-02-29T00:00:00Z"), "1709164800");
  EXPECT_EQ(seconds("1969-12-31T23:59:59Z"), "-1");
  EXPECT_EQ(seconds("2016-12-31T23:59:60Z"), "1483228800");  // the leap second
  EXPECT_EQ(seconds("23:59:59.5"), "86399.5");
}

TEST(DateTime, IsNothingElse) {
  for (const char* text : {"",
                           "1777636800",
                           "12.5",
                           "-1e5",
                           "2026-13-01",
                           "2026-02-30",
                           "2026-05-01T24:00:00",
                           "2026-05-01T12",
                           "2026-05-01T12:60:00",
                           "2026-05-01T12:00:61",
                           "2026-05-01T12:00:00.",
                           "2026-05-01T12:00:00.1.2",
                           "2026-05-01T12:00:00 CET",
                           "2026-05-01T12:00:00+2",
                           "2026-05-01X12:00:00",
                           "2026-05/01",
                           "26-05-01",
                           "12:30",
                           "25:00:00",
                           "2026-",
                           "1969-12-31T23:59:59.5Z",
                           "2026-05-01T12:00:00+24:00",
                           "2026-05-01T12:00:00.00000000000000000000000000000000000000000000000001Z"})
    EXPECT_EQ(seconds(text), "") << text;
}

TEST(DateTime, ACaptureMayHaveThemForItsTime) {
  const std::string rows =
      "2026-05-01T23:59:59.990000Z,0.5\n2026-05-02T00:00:00.000000Z,0.25\n2026-05-02T00:00:00.010000Z,0\n";
  const Capture numbers = parse_capture(
      "time_s,rate_radps\n1777679999.990000,0.5\n1777680000.000000,0.25\n1777680000.010000,0\n", "a.csv");
  const Capture dates = parse_capture("time_s,rate_radps\n" + rows, "a.csv");
  EXPECT_EQ(dates.time_s, numbers.time_s);
  EXPECT_EQ(dates.rate_radps, numbers.rate_radps);
  EXPECT_TRUE(dates.notices.empty());

  CsvLayout by;
  by.time = ifog::CsvTime::parse("Zeit");
  by.separator = ';';
  const Capture german = parse_capture(
      "Zeit;rate_radps\n2026-05-02 01:59:59,99+02:00;0,5\n2026-05-02 02:00:00,00+02:00;0,25\n"
      "2026-05-02 02:00:00,01+02:00;0\n",
      "a.csv", by);
  EXPECT_EQ(german.time_s, numbers.time_s);
  EXPECT_EQ(german.rate_radps, numbers.rate_radps);
}

TEST(DateTime, WhatIsWrongIsSaidByLine) {
  const std::string rows = "2026-05-01T12:00:00Z,1\n2026-05-01T12:00:01Z,2\n";
  EXPECT_EQ(ifog::refusal_of("Timestamp,GyroX (deg/s)\n" + rows), "accepted");
  CsvLayout ms;
  ms.time = ifog::CsvTime::parse("t:ms");
  EXPECT_EQ(ifog::refusal_of("t,rate_radps\n" + rows, ms),
            "a.csv:2: t is '2026-05-01T12:00:00Z', a date, which says its own unit, expected no other one of "
            "--time");
  EXPECT_EQ(ifog::refusal_of("time_s,rate_radps\n" + rows + "2026-05-01T11:59:59Z,1\n"),
            "a.csv:4: time_s is 1777636799 s, expected more than in the row before; --sample-rate HZ reads "
            "all rows as even");
  EXPECT_EQ(ifog::refusal_of("time_s,rate_radps\n" + rows + "2026-05-01T25:00:00Z,1\n"),
            "a.csv:4: time_s is '2026-05-01T25:00:00Z', expected a number, 'nan' or nothing");
}

}  // namespace
