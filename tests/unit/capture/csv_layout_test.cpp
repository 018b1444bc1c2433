// SPDX-License-Identifier: Apache-2.0
// CSV files of other makers: their columns, units, separators, and what a header that is nearly right is
// told.
#include "drivers/capture/columns/csv_layout.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

constexpr double kDegree = std::numbers::pi / 180.0;

CsvLayout layout(const std::vector<std::string>& columns, const std::string& time = "",
                 char separator = ',') {
  CsvLayout out;
  for (const std::string& column : columns) out.columns.push_back(CsvColumn::parse(column));
  if (!time.empty()) out.time = CsvTime::parse(time);
  out.separator = separator;
  return out;
}

using test::refusal;

TEST(CsvLayout, ReadsTheColumnsThatWereChosenInTheirUnits) {
  const Capture c = parse_capture(
      "\xEF\xBB\xBFsample;\"Gyro X\";T;t;mode\r\n1;-1,5;212;1000;auto\r\n2;0,5;32;1005;auto\r\n", "a.csv",
      layout({"rate_x_radps=Gyro X:deg/s", "temperature_degC=T:degF"}, "t:ms", ';'));
  EXPECT_EQ(c.axes, std::vector<std::string>{"x"});
  ASSERT_EQ(c.size(), 2U);
  EXPECT_DOUBLE_EQ(c.time_s[0], 1.0);
  EXPECT_DOUBLE_EQ(c.time_s[1], 1.005);
  EXPECT_DOUBLE_EQ(c.rate_radps[0][0], -1.5 * kDegree);
  EXPECT_DOUBLE_EQ(c.rate_radps[0][1], 0.5 * kDegree);
  ASSERT_EQ(c.channels.size(), 1U);
  EXPECT_EQ(c.channels[0].name, "temperature_degC");
  EXPECT_NEAR(c.channels[0].values[0], 100.0, 1e-12);
  EXPECT_NEAR(c.channels[0].values[1], 0.0, 1e-12);
}

// Names in Latin-1 are typed in a terminal's UTF-8.
TEST(CsvLayout, ATypedNameIsThatOfAHeaderInLatin1) {
  const CsvLayout typed = layout({"rate_radps=Gyro x [\u00B0/s]"}, "Zeit [s]");
  EXPECT_EQ(parse_capture("Zeit [s],Gyro x [\xB0/s]\n0,1\n1,180\n", "a.csv", typed).rate_radps[0][1],
            180 * kDegree);
}

TEST(CsvLayout, ATimeAloneLeavesTheOtherColumnsTheirNames) {
  const Capture c =
      parse_capture("rate_radps,stamp,supply_V\n1,10,12\n2,20,13\n", "a.csv", layout({}, "stamp:us"));
  EXPECT_DOUBLE_EQ(c.time_s[1], 20e-6);
  EXPECT_EQ(c.rate_radps[0], (std::vector<double>{1, 2}));
  EXPECT_EQ(c.channels.at(0).name, "supply_V");
}

// At 100 °/s through a hole of 5 s, and at rest through one of half a second.
TEST(CsvLayout, OverAHoleInWhichAnAngleMayHaveGoneRoundNoRateIsMadeUp) {
  const auto rates = [](const std::string& rows) {
    return parse_capture("time_s,heading\n" + rows, "a.csv", layout({"rate_z_radps=heading:deg"}))
        .rate_radps[0];
  };
  const std::vector<double> turning = rates("0,0\n0.1,10\n0.2,20\n5.2,160\n5.3,170\n");
  EXPECT_NEAR(turning[2], 100 * kDegree, 1e-9);
  EXPECT_TRUE(std::isnan(turning[3]));
  EXPECT_NEAR(turning[4], 100 * kDegree, 1e-9);
  const std::vector<double> resting = rates("0,10\n0.1,10\n0.2,10\n0.7,11\n0.8,11\n");
  EXPECT_NEAR(resting[3], 2 * kDegree, 1e-9);
}

TEST(CsvLayout, DifferencesOfAnAngleBecomeTheRate) {
  // 10 °/s, one angle missing, and a heading that passes north.
  const Capture wrapping = parse_capture("time_s,heading\n0,350\n1,\n2,10\n2.5,15\n", "a.csv",
                                         layout({"rate_z_radps=heading:deg"}));
  const std::vector<double>& rate = wrapping.rate_radps[0];
  EXPECT_TRUE(std::isnan(rate[0]));
  EXPECT_TRUE(std::isnan(rate[1]));
  EXPECT_NEAR(rate[2], 10 * kDegree, 1e-12);
  EXPECT_NEAR(rate[3], 10 * kDegree, 1e-12);
  // An angle that goes on beyond a turn does not wrap: 300° in a second are 300 °/s.
  const Capture counting =
      parse_capture("time_s,a\n0,0\n1,300\n2,600\n", "a.csv", layout({"rate_radps=a:deg"}));
  EXPECT_NEAR(counting.rate_radps[0][1], 300 * kDegree, 1e-12);
}

// A KVH 1750 at 770 Hz in stamps of whole milliseconds (kvh_1750_troubleshooting): steps of one and of two. 1 mrad each.
// An angle that is read when a sketch comes round to it is as uneven as its stamps.
TEST(CsvLayout, AnAngleIsDividedByTheTimeThatItTook) {
  const auto rates = [](const char* unit, auto&& row) {
    std::string text = "t,d\n";
    for (int i = 0; i < 2000; ++i) text += row(i);
    return parse_capture(text, "a.csv", layout({std::string("rate_x_radps=d:") + unit}, "t:ms"))
        .rate_radps[0];
  };
  const auto ticks = [](int i) { return std::to_string(1000 * i / 770) + ","; };
  const std::vector<double> each = rates("mrad/sample", [&](int i) { return ticks(i) + "1\n"; });
  const std::vector<double> angle = rates("mrad", [&](int i) { return ticks(i) + std::to_string(i) + "\n"; });
  std::mt19937 random(3);
  double at_ms = 0.0;
  const std::vector<double> uneven = rates("mrad", [&](int) {
    at_ms += std::uniform_real_distribution<double>(1.0, 9.0)(random);
    return std::to_string(at_ms) + "," + std::to_string(0.77 * at_ms) + "\n";
  });
  for (std::size_t i = 1; i < 2000; ++i) {
    ASSERT_NEAR(each[i], 0.77, 2e-4) << i;
    ASSERT_NEAR(angle[i], 0.77, 2e-4) << i;
    ASSERT_NEAR(uneven[i], 0.77, 1e-5) << i;
  }
}

// Xsens MT export: 500 packets are lost, later two. The counter is of 16 bits, and a damaged line and a wrong count cost
// no time.
TEST(CsvLayout, AJumpOfTheCounterOfRowsIsAGap) {
  CsvLayout rate;
  rate.sample_rate_hz = 100;
  rate.columns = {CsvColumn::parse("rate_x_radps=Gyr_X:rad/s")};
  std::string text = "PacketCounter,Gyr_X\n";
  for (int i = 0; i < 2000; ++i)
    if (i < 1000 || (i >= 1500 && i != 1700 && i != 1701))
      text += std::to_string(i == 300 ? 9999 : (64000 + i) % 65536) + (i == 200 ? ",??\n" : ",0.1\n");
  const Capture got = parse_capture(text, "a.csv", rate);
  ASSERT_EQ(got.size(), 1497U);
  EXPECT_EQ(got.origin.s, 0);
  std::size_t row = 0;
  for (int i = 0; i < 2000; ++i)
    if (i != 200 && (i < 1000 || (i >= 1500 && i != 1700 && i != 1701))) {
      ASSERT_NEAR(got.time_s[row++], 0.01 * i, 1e-9) << i;
    }
  EXPECT_EQ(got.notices, std::vector<std::string>{
                             "a.csv: of the rows that 'PacketCounter' counts 503 are missing: gaps in time"});
}

// VMU931: whole milliseconds, of which some stand twice and some are missing, are no seconds.
TEST(CsvLayout, WholeSecondsIncreaseByOneAtMost) {
  std::string text = "Time stamp,gyro_x\n";
  for (int i = 0; i < 40; ++i)
    text += std::to_string(156496 + i + (i % 4 == 2 ? 1 : 0)) + ",0.00" + std::to_string(i % 7) + "\n";
  const std::string said = refusal_of(text);
  EXPECT_TRUE(test::has(said, "--time 'Time stamp:ms'")) << said;
  EXPECT_TRUE(test::has(said, "in the place of ms: us, ns, s;")) << said;
}

// A second reference is only listed, and a set point is no reference.
TEST(CsvLayout, OneReferenceIsOffered) {
  const auto notices = [](const std::string& header) {
    return parse_capture(rows_of(header, "0.{i},{x},{x},{y}"), "a.csv").notices.back();
  };
  EXPECT_EQ(notices("time_s,gyro_x_dps,gt_rate_x_dps,table_rate_x_dps\n"),
            "a.csv: not read: 'table_rate_x_dps'");
  EXPECT_EQ(notices("time_s,gyro_x_dps,rate_x_desired_dps,rate_x_cmd_dps\n"),
            "a.csv: not read: 'rate_x_desired_dps', 'rate_x_cmd_dps'");
}

// vehicle_imu of PX4, thinned out to 2 Hz, and loggers that name the unit, or none: 1 mrad in 4 ms each. An interval that
// is longer than the rows are apart is of something else.
TEST(CsvLayout, AnIncrementIsOfTheIntervalInItsRow) {
  for (const auto& [header, interval, chosen, rate] :
       std::initializer_list<std::tuple<const char*, const char*, CsvLayout, double>>{
           {"timestamp,delta_angle[0],delta_velocity_dt,delta_angle_dt", "8000,4000", {}, 0.25},
           {"timestamp_us,dtheta_x_rad,n,dt_s", "1,0.004", {}, 0.25},
           {"t,DelAX,DelvT,DelaT", "0.008,0.004", layout({"rate_x_radps=DelAX:rad/sample"}, "t:us"), 0.25},
           {"t,a,b,dt", "1,4000", layout({"rate_x_radps=#2:rad/sample", "interval_s=dt:us"}, "t:us"), 0.25},
           {"timestamp_us,dtheta_x_rad,n,dt_s", "1,4", {}, 0.002}}) {
    std::string text = std::string(header) + "\n";
    for (std::int64_t i = 0; i < 42; ++i)
      text += std::to_string(1'710'773'350'710'000 + 500'000 * i) + ",0.001," +
              (i < 40    ? interval
               : i == 40 ? "1,"
                         : "1,0") +
              "\n";
    const Capture got = parse_capture(text, "a.csv", chosen);
    const std::string said = got.notices.empty() ? "" : got.notices[0];
    EXPECT_NEAR(got.rate_radps.at(0).at(7), rate, 1e-9 * rate) << header << said;
    EXPECT_EQ(test::has(said, "interval"), rate == 0.25 && chosen.columns.size() < 2) << said;
    EXPECT_EQ(std::isnan(got.rate_radps[0][40]) && std::isnan(got.rate_radps[0][41]), rate == 0.25);
  }
}

TEST(CsvLayout, IncrementsAreTheTurnWithinAPeriod) {
  // 0.36 arcsec in 10 ms are 36 arcsec/s: behind a hole as well, and in a row that came late.
  const Capture got =
      parse_capture("t,d\n0,0.36\n0.01,0.36\n0.02,\n0.05,0.36\n0.061,0.36\n0.07,-0.72\n0.08,0.36\n", "a.csv",
                    layout({"rate_x_radps=d:arcsec/sample"}, "t"));
  const double rate = 36.0 / 3600.0 * kDegree;
  const std::vector<double> expected{rate, rate, NAN, rate, rate, -2 * rate, rate};
  for (std::size_t i = 0; i < expected.size(); ++i)
    if (std::isnan(expected[i]))
      EXPECT_TRUE(std::isnan(got.rate_radps[0][i])) << i;
    else
      EXPECT_NEAR(got.rate_radps[0][i], expected[i], 1e-12 * rate) << i;
  // Of what no sensor measures the cell is said.
  EXPECT_EQ(refusal([] {
              parse_capture("t,d\n0,0\n0.001,100\n", "a.csv", layout({"rate_x_radps=d:rad/sample"}, "t"));
            }),
            "a.csv:3: d has turned at 1e+05 rad/s since the row before, which no sensor measures");
}

TEST(CsvLayout, SaysWhatIsWrongWithAnOption) {
  const auto column = [](const std::string& text) { return refusal([&] { CsvColumn::parse(text); }); };
  EXPECT_EQ(column("rate_x_radps"), "'rate_x_radps', expected NAME=HEADER:UNIT, rate_x_radps=GyroX:deg/s");
  EXPECT_EQ(column("rate=GyroX"), "'rate=GyroX', expected NAME=HEADER:UNIT, rate_x_radps=GyroX:deg/s");
  EXPECT_EQ(column("temperature_degC=T:V"),
            "'temperature_degC=T:V', expected a unit that becomes degC: degC, degF, K");
  EXPECT_EQ(column("ramp_counts=R:V"),
            "'ramp_counts=R:V', expected the unit counts, which is known by its name only");
  EXPECT_EQ(column("rate_radps=w:m/s").substr(0, 70),
            "'rate_radps=w:m/s', expected a unit that becomes radps: rad/s, deg/s, ");
  EXPECT_EQ(column("time_s=t"), "'time_s=t', expected another name; --time says which column is the time");
  EXPECT_EQ(refusal([] { CsvTime::parse("t:m"); }),
            "'t:m', expected HEADER:UNIT with a unit of time: s, ms, us, 100us, ns, min, h, d; d/m/y or "
            "m/d/y of dates");
  EXPECT_EQ(refusal([] { CsvLayout::parse_separator("::"); }),
            "'::', expected one character that stands between cells, ';', or the word tab");
  EXPECT_EQ(CsvLayout::parse_separator("tab"), '\t');
}

TEST(CsvLayout, SaysWhatIsWrongWithAFile) {
  const CsvLayout by = layout({"rate_radps=w:deg/s"}, "t:s");
  EXPECT_EQ(refusal_of("t,g\n0,1\n", by), "a.csv:1: no column 'w', the header has 't', 'g'");
  EXPECT_EQ(refusal_of("t,u,g\n0,1,2\n1,2,3\n", layout({"rate_radps=#6:deg/s"})),
            "a.csv:1: no column '#6', the header has 't', 'u', 'g'");
  EXPECT_EQ(refusal_of("t,w,w\n0,1,1\n", by),
            "a.csv:1: more than one column 'w', #2, #3, the header has 't', 'w', 'w'");
}

TEST(CsvLayout, ARowBelowTheNamesSaysTheUnits) {
  const Capture plain = parse_capture(
      "time_s,rate_radps,T,ramp_counts,flag\ns,[rad/s],degC,counts,-\n0,1,20,5,0\n1,2,21,6,1\n", "a.csv");
  EXPECT_EQ(plain.time_s, (std::vector<double>{0, 1}));
  EXPECT_EQ(plain.rate_radps[0], (std::vector<double>{1, 2}));
  ASSERT_EQ(plain.channels.size(), 3U);
  EXPECT_EQ(plain.channels[0].name, "T_degC");
  EXPECT_EQ(plain.channels[1].name, "ramp_counts");
  EXPECT_EQ(plain.channels[2].name, "flag");

  const char* const logger = "t,GyroX,Temp\nms,deg/s,degF\n0,90,32\n10,180,212\n";
  EXPECT_EQ(parse_capture(logger, "a.csv").notices.front(),
            "a.csv: read as: time 't' in ms, rate_x 'GyroX' in deg/s, temp 'Temp' in degF");
  // Who chooses a column without a unit gets that of the row.
  for (const auto& [rate, time] :
       {std::pair{"rate_x_radps=GyroX:deg/s", "t:ms"}, std::pair{"rate_x_radps=GyroX", "t"}}) {
    const Capture chosen = parse_capture(logger, "a.csv", layout({rate, "temperature_degC=Temp"}, time));
    EXPECT_EQ(chosen.time_s, (std::vector<double>{0, 0.01}));
    EXPECT_NEAR(chosen.rate_radps[0][1], 180 * kDegree, 1e-12);
    EXPECT_NEAR(chosen.channels[0].values[1], 100, 1e-9);
  }
  EXPECT_EQ(
      refusal_of("time_s,rate_radps,temperature_degC\ns,rad/s,K\n0,1,293\n"),
      "a.csv:1: the unit of 'temperature_degC' is given as 'K', expected that of its name; to read it so: "
      "--column temperature_degC=temperature_degC:K");
  // Lines count on, and what is no row of units is a row.
  EXPECT_EQ(refusal_of("time_s,rate_radps\ns,rad/s\n1,1\n0,2\n"),
            "a.csv:4: time_s is 0 s, expected more than in the row before; --sample-rate HZ reads all rows "
            "as even");
  EXPECT_EQ(refusal_of("time_s,rate_radps\nnone,NA\n0,1\n"), "a.csv:2: time_s is missing, expected a time");
  EXPECT_EQ(refusal_of("time_s,rate_radps\n0,rad\n").substr(0, 30), "a.csv:2: rate_radps is 'rad', ");
}

TEST(CsvLayout, AHeaderOfAnotherUnitIsNotTakenForTheTargets) {
  const std::string text = "t_ms,rate_dps,temperature_degF,supply_V,angle_deg\n0,90,77,12,0\n5,90,77,12,1\n";
  const Capture c = parse_capture(
      text, "a.csv",
      layout({"rate_radps=rate_dps", "temperature_degC=temperature_degF", "supply_mV=supply_V"}, "t_ms"));
  EXPECT_DOUBLE_EQ(c.time_s[1], 5e-3);
  EXPECT_DOUBLE_EQ(c.rate_radps[0][0], 90 * kDegree);
  for (const auto& [channel, value] : {std::pair{0U, 25.0}, std::pair{1U, 12e3}})
    EXPECT_NEAR(c.channels[channel].values[0], value, 1e-9);
  EXPECT_EQ(refusal_of(text, layout({"rate_radps=angle_deg"}, "t_ms")),
            "a.csv:1: 'angle_deg' is in 'deg' by its name, and no unit was given; to read it so: --column "
            "rate_radps=angle_deg:deg");
}

TEST(CsvLayout, MillisecondsTakenForSecondsAreSaid) {
  std::string milliseconds = "time_s,rate_radps\n", seconds = milliseconds, dwells = milliseconds;
  for (int i = 0; i < 20; ++i) {
    milliseconds += std::to_string(5 * i) + ",0\n";
    seconds += std::to_string(i / 200.0) + ",0\n";
    dwells += std::to_string(16 * i) + ".0,0\n";  // a rate table's: nobody writes tenths of milliseconds
  }
  const Capture c = parse_capture(milliseconds, "a.csv");
  EXPECT_EQ(c.time_s.back(), 95.0);  // not changed
  EXPECT_EQ(c.notices,
            (std::vector<std::string>{"a.csv: time_s is whole numbers, 5 s apart in the mean; if these are "
                                      "milliseconds: --time time_s:ms"}));
  EXPECT_TRUE(parse_capture(seconds, "a.csv").notices.empty());
  EXPECT_TRUE(parse_capture(dwells, "a.csv").notices.empty());
  EXPECT_TRUE(parse_capture(milliseconds, "a.csv", layout({}, "time_s:ms")).notices.empty());
}

}  // namespace
}  // namespace ifog
