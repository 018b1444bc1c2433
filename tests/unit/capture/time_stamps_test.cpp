// SPDX-License-Identifier: Apache-2.0
// Times in digits and dates. That a series of any start and unit is the same series is checked by
// system/command_line/origins.py.
#include "drivers/capture/times/time_stamps.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace {

using ifog::Decimal;
using ifog::SaidTime;
using ifog::TimeOrigin;
using ifog::TimeStamps;

double since(const std::string& first, double unit_s, const std::string& text) {
  return TimeStamps(Decimal::parse(first), unit_s).since(Decimal::parse(text).value()).value();
}

TimeOrigin origin(const std::string& first, double unit_s) {
  return TimeStamps(Decimal::parse(first), unit_s).origin();
}

std::string told(const TimeOrigin& origin, double since_s) {
  std::string text;
  ifog::append_time(text, origin, since_s);
  return text;
}

TEST(TimeStamps, LoseNoDigitOfAnEpoch) {
  EXPECT_EQ(since("1700000000.123456789", 1.0, "1700000000.123456789"), 0.0);
  EXPECT_EQ(since("1700000000.123456789", 1.0, "1700086399.999999999"), 86399.87654321);
  EXPECT_EQ(since("1700000000.5", 1.0, "1700000000.1234567890125"), -0.3765432109875);
  EXPECT_EQ(since("1700000000123456789", 1e-9, "1700000000123456790"), 1e-9);
  EXPECT_EQ(since("1700000000123.5", 1e-3, "1700000000124.25"), 0.00075);
  EXPECT_EQ(since("-1700000000.5", 1.0, "-1700000000.49"), 0.01);
  EXPECT_EQ(origin("-1700000000.5", 1.0), (TimeOrigin{-1700000001, 500'000'000}));
  EXPECT_EQ(origin("1700000000123456789", 1e-9), (TimeOrigin{1700000000, 123'456'789}));
  // No more than whole ns are counted from.
  EXPECT_EQ(origin("1700000000123.4567891", 1e-3), (TimeOrigin{1700000000, 123'456'789}));
  EXPECT_EQ(since("1700000000123.4567891", 1e-3, "1700000000123.4567891"), 1e-10);
  EXPECT_EQ(origin("28333333", 60.0), (TimeOrigin{28333333LL * 60, 0}));
}

TEST(TimeStamps, StandAsTheyAreWhereADoubleHoldsThem) {
  for (const std::string first : {"0", "12.5", "-3.75", "1023.999", "nan", "", "1e9", "time"})
    EXPECT_EQ(origin(first, 1.0), TimeOrigin{}) << first;
  for (const std::string text : {"0.01", "+0.01", "17.", ".5", "-0.3", "123456.789012345"})
    EXPECT_EQ(since("0", 1.0, text), std::stod(text)) << text;
  // What is not plain is left to others.
  for (const std::string text : {"", "-", ".", "1e3", "nan", "1.5x", " 1", "99999999999999999999"})
    EXPECT_FALSE(Decimal::parse(text)) << text;
}

TEST(TimeStamps, AreHeldToWhatHasRoom) {
  EXPECT_EQ(origin("4500000000000000000", 3600.0), TimeOrigin{});
  EXPECT_EQ(origin("9223372036854775807", 1e-9), TimeOrigin{});
  EXPECT_EQ(since("-4599999999999999999", 1e-9, "4599999999999999999"), 9199999999.999999999);
  EXPECT_EQ(TimeOrigin::of(INT64_MIN), (TimeOrigin{-9223372037, 145'224'192}));
  EXPECT_EQ(TimeOrigin::of(INT64_MAX), (TimeOrigin{9223372036, 854'775'807}));
  EXPECT_EQ(TimeOrigin::of(INT64_MIN).in_ns(0.0), INT64_MIN);
  EXPECT_EQ(TimeOrigin::of(INT64_MAX).in_ns(-1e-9), INT64_MAX - 1);
  EXPECT_EQ(TimeOrigin::of(-1'700'000'000'500'000'000), (TimeOrigin{-1700000001, 500'000'000}));
  EXPECT_EQ(TimeOrigin::of(1'000'000'000), TimeOrigin{});
}

TEST(TimeStamps, AreToldInTheDigitsTheyCameWith) {
  EXPECT_EQ(told({1700000000, 0}, 0.123456789), "1700000000.123456789");
  EXPECT_EQ(told({1700000000, 0}, 1.0), "1700000001");
  EXPECT_EQ(told({-1700000001, 0}, 0.51), "-1700000000.49");
  EXPECT_EQ(told({-2000, 0}, 1999.25), "-0.75");
  EXPECT_EQ(told({-2000, 0}, 2000.0), "0");
  EXPECT_EQ(told({5000, 0}, -0.25), "4999.75");
  const TimeOrigin origin{1700000000, 123'456'789};
  EXPECT_EQ(told(origin, 0.0), "1700000000.123456789");
  EXPECT_EQ(told(origin, 0.876543211), "1700000001");
  EXPECT_EQ(told(origin, 0.0000000000025), "1700000000.1234567890025");
  EXPECT_EQ(told(origin, -1.0), "1699999999.123456789");
  EXPECT_EQ(told(origin, -0.123456789), "1700000000");
  EXPECT_EQ(told({-1700000001, 500'000'000}, 0.5), "-1700000000");
  EXPECT_EQ(origin.in_s(0.076543211), 1700000000.2);
  EXPECT_EQ(origin.in_ns(0.01), 1'700'000'000'133'456'789);
  EXPECT_EQ(origin.later_than({1699999999, 123'456'790}), 0.999999999);
}

TEST(SaidTime, IsBeforeAndBehindWhatItSays) {
  const TimeOrigin origin{1700000000, 123'456'789};
  const SaidTime said = *SaidTime::parse("1700000000.133456789");
  EXPECT_TRUE(said.is_after(origin, 0.009999999));
  EXPECT_FALSE(said.is_after(origin, 0.01));
  EXPECT_FALSE(SaidTime::parse("1.7e9")->is_after(origin, 0.0));
  EXPECT_TRUE(SaidTime::parse("-0.5")->is_after({}, -0.500000001));
  EXPECT_FALSE(SaidTime::parse("-0.5")->is_after({}, -0.5));
  EXPECT_TRUE(SaidTime::parse("1e300")->is_after(origin, 1e9));
  for (const std::string text : {"", "x", "1s", "inf", "nan"}) EXPECT_FALSE(SaidTime::parse(text)) << text;
}

std::string seconds(const std::string& text) {
  const auto date = ifog::date_time(text);
  if (!date) return "";
  std::string digits;
  ifog::append_time(
      digits, {static_cast<std::int64_t>(date->with(0)), 0},
      Decimal{date->value - Decimal{date->with(0)}.with(date->decimals), date->decimals}.in_double());
  return digits;
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
  EXPECT_EQ(seconds("2026-05-01T12:00:00.250+02:00"), "1777629600.25");
  EXPECT_EQ(seconds("2026-05-01T12:00:00-0530"), "1777656600");
  EXPECT_EQ(seconds("2026-05-01 12:00:00 UTC"), "1777636800");
  EXPECT_EQ(seconds("2024-02-29T00:00:00Z"), "1709164800");
  EXPECT_EQ(seconds("1969-12-31T23:59:59Z"), "-1");
  EXPECT_EQ(seconds("1969-12-31T23:59:58.5Z"), "-1.5");
  EXPECT_EQ(seconds("2016-12-31T23:59:60Z"), "1483228800");  // the leap second
  EXPECT_EQ(seconds("23:59:59.5"), "86399.5");
}

TEST(DateTime, IsNothingElse) {
  EXPECT_EQ(seconds(""), "");
  std::istringstream texts(
      "1777636800;12.5;-1e5;2026-13-01;2026-02-30;2026-05-01T24:00:00;2026-05-01T12;2026-05-01T12:60:00;"
      "2026-05-01T12:00:61;2026-05-01T12:00:00.;2026-05-01T12:00:00.1.2;2026-05-01T12:00:00 CET;"
      "2026-05-01T12:00:00+2;2026-05-01X12:00:00;2026-05/"
      "01;26-05-01;12:30;25:00:00;2026-;"
      "2026-05-01T12:00:00+24:00;2026-05-01T12:00:00.00000000000000000000000000000000000000000000000001Z");
  for (std::string text; std::getline(texts, text, ';');) EXPECT_EQ(seconds(text), "") << text;
}

TEST(DateTime, WhatIsWrongIsSaidByLine) {
  const std::string rows = "2026-05-01T12:00:00Z,1\n2026-05-01T12:00:01Z,2\n";
  EXPECT_EQ(ifog::refusal_of("Timestamp,GyroX (deg/s)\n" + rows), "accepted");
  ifog::CsvLayout ms;
  ms.time = ifog::CsvTime::parse("t:ms");
  EXPECT_EQ(ifog::refusal_of("t,rate_radps\n" + rows, ms),
            "a.csv:2: t is '2026-05-01T12:00:00Z', a date, which says its own unit, expected no other one of "
            "--time");
  EXPECT_EQ(ifog::refusal_of("time_s,rate_radps\n" + rows + "2026-05-01T25:00:00Z,1\n"),
            "a.csv:4: time_s is '2026-05-01T25:00:00Z', expected a number, 'nan' or nothing");
}

}  // namespace
