// SPDX-License-Identifier: Apache-2.0
// CSV files of other makers: their columns, units, separators, and what a header that is nearly right is
// told.
#include "drivers/capture/columns/csv_layout.h"

#include <gtest/gtest.h>

#include <cmath>
#include <cstdint>
#include <numbers>
#include <stdexcept>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "tests/unit/capture/refusal.h"

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

template <typename Read>
std::string refusal(Read&& read) {
  try {
    read();
  } catch (const std::runtime_error& error) {
    return error.what();
  }
  return "accepted";
}

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

TEST(CsvLayout, IncrementsAreTheTurnWithinAPeriod) {
  // 0.36 arcsec in 10 ms are 36 arcsec/s: behind a hole as well, and in a row that came late.
  const Capture got =
      parse_capture("t,d\n0,0.36\n0.01,0.36\n0.02,\n0.05,0.36\n0.061,0.36\n0.07,-0.72\n0.08,0.36\n", "a.csv",
                    layout({"rate_x_radps=d:arcsec/sample"}, "t"));
  const double rate = 36.0 / 3600.0 * kDegree;
  const std::vector<double> expected{rate, rate, NAN, rate, rate, -2 * rate, rate};
  for (std::size_t i = 0; i < expected.size(); ++i) {
    if (std::isnan(expected[i]))
      EXPECT_TRUE(std::isnan(got.rate_radps[0][i])) << i;
    else
      EXPECT_NEAR(got.rate_radps[0][i], expected[i], 1e-12 * rate) << i;
  }
  EXPECT_EQ(refusal([] { CsvColumn::parse("rate_x_radps=d:V/sample"); }).substr(0, 52),
            "'rate_x_radps=d:V/sample', expected a unit that beco");
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
            "'t:m', expected HEADER:UNIT with a unit of time: s, ms, us, 100us, ns, min, h, d");
  EXPECT_EQ(refusal([] { CsvLayout::parse_separator("::"); }),
            "'::', expected one character that stands between cells, ';', or the word tab");
  EXPECT_EQ(CsvLayout::parse_separator("tab"), '\t');
}

TEST(CsvLayout, SaysWhatIsWrongWithAFile) {
  const CsvLayout by = layout({"rate_radps=w:deg/s"}, "t:s");
  EXPECT_EQ(refusal_of("t,g\n0,1\n", by), "a.csv:1: no column 'w', the header has 't', 'g'");
  EXPECT_EQ(refusal_of("t,w,w\n0,1,1\n", by),
            "a.csv:1: more than one column 'w', the header has 't', 'w', 'w'");
  EXPECT_EQ(
      refusal_of("t,w\n1,1\n0,2\n", by),
      "a.csv:3: t is 0 s, expected more than in the row before; --sample-rate HZ reads all rows as even");
  EXPECT_EQ(refusal_of("t,w\n0,1,5\n", by), "a.csv:2: more cells than the 2 columns of the header");
  EXPECT_EQ(refusal_of("t,w\n0,1e9\n", by).substr(0, 46), "a.csv:2: w is '1e9', which no sensor measures,");
  EXPECT_EQ(refusal_of("t,w\n0,0\n# note\n1e-9,3\n", layout({"rate_radps=w:rad"}, "t:s")).substr(0, 21),
            "a.csv:4: w has turned");
  EXPECT_EQ(refusal_of("\xFF\xFEt", {}),
            "a.csv: is text in UTF-16, expected UTF-8; 'iconv -f UTF-16 -t UTF-8' makes it");
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

// What is read without options, and what is asked for where the names leave a question.
TEST(CsvLayout, AForeignHeaderIsReadWhereItIsClear) {
  const auto said = [](const char* header) {
    const std::string text = std::string(header) + "\n0,1,2,3\n0.01,1,3,3\n0.02,2,1,3\n0.03,1,2,3\n";
    try {
      const Capture read = parse_capture(text, "a.csv");
      return read.notices.empty() ? std::string("as named") : read.notices.front();
    } catch (const std::runtime_error& error) {
      return std::string(error.what());
    }
  };
  const std::string read = "a.csv: read as: ", asked = "a.csv:1: ";
  EXPECT_EQ(said("Time [s],GyroX (deg/s),AccX (g),T"),
            read + "time 'Time [s]' in s, rate_x 'GyroX (deg/s)' in deg/s, accx 'AccX (g)' in g");
  EXPECT_EQ(said("Time_s,Rate_radps,Temperature_degC,mode"),
            read + "time 'Time_s' in s, rate 'Rate_radps' in radps, temperature 'Temperature_degC' in degC");
  EXPECT_EQ(said("time_s,frame_rate_hz,gyro_x_dps,gyro_x_dps_std"),
            read + "time 'time_s' in s, rate_x 'gyro_x_dps' in dps");
  EXPECT_EQ(said("time_s,raw_x_radps,denoised_x_radps,T"),
            "a.csv:1: no rate column among 'raw_x_radps', 'denoised_x_radps', 'T', expected 'rate_radps' or "
            "'rate_x_radps', …, or --column rate_x_radps=NAME:UNIT with one of these names");
  EXPECT_EQ(said("a,b,c,d").substr(0, asked.size() + 35), asked + "no rate column among 'a', 'b', 'c',");
  EXPECT_EQ(
      said("t,wx,wy,c"),
      asked +
          "the unit of the rate is not named; to read it: --time t:s --column rate_x_radps=wx:rad/s --column "
          "rate_y_radps=wy:rad/s; in the place of rad/s: deg/s, rad/sample, deg/sample");
  EXPECT_EQ(said("time_s,gyro1_x_dps,gyro2_x_dps,T").substr(0, asked.size() + 44),
            asked + "more than one column may be the rate; to rea");
  EXPECT_EQ(said("x,gyro_x_dps,b,c").substr(0, asked.size() + 30), asked + "no time column; to read it: --");
}

// Without a unit the cells were taken for what they were to become, against their own name.
TEST(CsvLayout, AHeaderOfAnotherUnitIsNotTakenForTheTargets) {
  const std::string text =
      "time_s,rate_dps,temperature_degF,angle_deg,t_ms,supply_V\n0,1,77,0,0,12\n1,1,77,1,5,12\n";
  const auto read = [&](const std::string& column, const std::string& time = "") {
    return refusal([&] {
      parse_capture(text, "a.csv", layout({column, "rate_y_radps=rate_dps:dps"}, time));
    });
  };
  const auto said = [](const std::string& header, const std::string& unit, const std::string& option) {
    return "a.csv:1: '" + header + "' is in '" + unit +
           "' by its name, and no unit was told; to read it so: " + option;
  };
  EXPECT_EQ(refusal([&] { parse_capture(text, "a.csv", layout({"rate_radps=rate_dps"})); }),
            said("rate_dps", "dps", "--column rate_radps=rate_dps:dps"));
  EXPECT_EQ(read("temperature_degC=temperature_degF"),
            said("temperature_degF", "degF", "--column temperature_degC=temperature_degF:degF"));
  EXPECT_EQ(read("rate_x_radps=angle_deg"), said("angle_deg", "deg", "--column rate_x_radps=angle_deg:deg"));
  EXPECT_EQ(read("supply_V=supply_V", "t_ms"), said("t_ms", "ms", "--time t_ms:ms"));
  EXPECT_EQ(read("supply_mV=supply_V"), said("supply_V", "V", "--column supply_mV=supply_V:V"));
  // Who says the unit is believed, and so is who names the header's own.
  EXPECT_EQ(read("temperature_degC=temperature_degF:degC"), "accepted");
  EXPECT_EQ(read("coil_degF=temperature_degF", "t_ms:ms"), "accepted");
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

// A row for each of `rows`: what stands before, between and behind the rates, {i} being the row's number and
// {x}, {y}, {z} white noise of 0.001.
std::string rows_of(const std::string& head, const std::string& form, int rows = 40) {
  std::string text = head;
  std::uint32_t dice = 1;
  for (int i = 0; i < rows; ++i) {
    std::string row = form;
    const auto put = [&row](const std::string& name, const std::string& value) {
      for (std::size_t at; (at = row.find(name)) != std::string::npos;) row.replace(at, name.size(), value);
    };
    for (const char* axis : {"{x}", "{y}", "{z}"}) {
      dice = dice * 1664525U + 1013904223U;
      put(axis, std::to_string(1e-3 * (static_cast<double>(dice >> 16U) / 32768.0 - 1.0)));
    }
    put("{count}", std::to_string(static_cast<int>(dice >> 20U) - 2048));
    put("{angle}", std::to_string(3.0 + 1e-3 * i));
    put("{digit}", std::to_string(7 * i % 10));
    put("{i}", std::to_string(100 + i));
    text += row + "\n";
  }
  return text;
}

TEST(CsvLayout, FilesOfOtherProgramsAreReadOrOfferedRight) {
  struct Case {
    std::string text;
    std::vector<std::string> said;
  };
  const std::vector<Case> cases = {
      // KAIST Complex Urban data set, fog.csv: a FOG's increments in rad.
      {rows_of("", "15445907980{i}0000000,{x},{y},{z}"),
       {"--time '#1:ns' --column 'rate_x_radps=#2:rad/s'",
        "; in the place of rad/s: deg/s, rad/sample, deg/sample"}},
      // NCLT data set, kvh.csv: the heading of a FOG.
      {rows_of("", "13578472480{i}0000,{angle}"),
       {"--column 'rate_radps=#2:rad'", "in the place of rad: deg, rad/s"}},
      // VectorNav, user manual, $VNIMU: magnetic field, acceleration, rates, temperature, pressure.
      {rows_of(
           "",
           "$VNIMU,-00.0350,+00.4222,-00.6643,-00.015,+00.019,+09.80{digit},{x},{y},{z},+20.7,+084.322*00"),
       {"to read it: --sample-rate HZ --column 'rate_x_radps=#8:rad/s' --column 'rate_y_radps=#9:rad/s' "
        "--column "
        "'rate_z_radps=#10:rad/s'; in"}},
      // OxIOD data set, imu.csv: roll, pitch, yaw, rates, gravity.
      {rows_of("", "1505306516.{i},0.01,0.02,{angle},{x},{y},{z},0.1,0.2,0.97"),
       {"--column 'rate_x_radps=#5:rad/s' --column 'rate_y_radps=#6:rad/s' --column 'rate_z_radps=#7:rad/s'; "
        "in"}},
      // Analog Devices, ADIS16495 data logger: registers.
      {rows_of("Timestamp,X_GYRO_OUT\n", "0.{i},{count}"),
       {"whole numbers are often counts", "--column rate_x_radps=X_GYRO_OUT:0.005deg/s"}},
      // Laser gyro test stands write the arcsecond's sign.
      {rows_of("Time [s]; Rate X [\"/s]\n", "0.{i}; {x}"), {"rate_x 'Rate X [\"/s]' in \"/s"}},
      // MATLAB datenum and Excel serial dates: days.
      {rows_of("time,gyro_x_dps\n", "738856.500{i}57858,{x}"), {"read as: time 'time' in d"}},
      {rows_of("time_days,gyro_x_dps\n", "0.00000{i},{x}"), {"read as: time 'time_days' in d"}},
      // Movella DOT data exporter: the stated rate tells that its clock is of us.
      {rows_of("sep=,\nDeviceTag:,DOT1\nOutputRate:,100Hz\nPacketCounter,SampleTimeFine,Gyr_X\n",
               "{i},3{i}0000,{x}"),
       {"--time SampleTimeFine:us"}},
      // TEX-CUP data set: week, second, fraction of the second.
      {rows_of("", "2051 240000 0.{i} {x} -0.0475 9.808 {x} {y} {z}"),
       {"--sample-rate HZ --column 'rate_x_radps=#7:"}},
      // Malaga data set, MRPT: the header begins with %.
      {rows_of("%  Time  IMU_YAW_VEL  IMU_PITCH_VEL  IMU_ROLL_VEL\n", " 1261228426.{i} {z} {y} {x}"),
       {"--time Time:s --column rate_z_radps=IMU_YAW_VEL:rad/s"}},
      // NovAtel OEM7, abbreviated ASCII log RAWIMUSXA among others.
      {rows_of("#BESTPOSA,COM1,0,72.0;SOL_COMPUTED,SINGLE,51.11*3c6da5d7\n",
               "%RAWIMUSXA,2075,507495.{i};00,13,2075,507495.165000000,00000000,32068,-1612,-1320,{count},-{"
               "i},1{i}*3c6da5d7"),
       {"rate_x_radps=#12:", "rate_z_radps=#14:"}},
      // NI LabVIEW measurement file: two heads, a decimal comma, a name without cells.
      {rows_of("LabVIEW Measurement\t\nSeparator\tTab\n***End_of_Header***\t\n\nChannels\t1\nSamples\t40\n"
               "Y_Unit_Label\tdeg/s\nDelta_X\t0,010000\n***End_of_Header***\t\nX_Value\tGyro X\tComment\n",
               "0,{i}000\t0,{i}"),
       {"to read it: --sample-rate 100 --column 'rate_x_radps=Gyro X:deg/s'"}},
      // Spreadsheets: one name over three columns.
      {rows_of("time (s),gyro,gyro,gyro\n", "0.{i},{x},{y},{z}"),
       {"--column 'rate_x_radps=#2:rad/s' --column 'rate_y_radps=#3:rad/s' --column "
        "'rate_z_radps=#4:rad/s'"}},
      // GoPro telemetry extractor: the axis stands in brackets, and z first.
      {rows_of("t [s],Gyroscope (z) [rad/s],Gyroscope (x) [rad/s]\n", "0.{i},{z},{x}"),
       {"rate_z 'Gyroscope (z) [rad/s]' in rad/s, rate_x 'Gyroscope (x) [rad/s]' in rad/s"}},
      // x-IMU GUI, CalInertialAndMag.csv: G is gauss.
      {rows_of("Packet number,Gyroscope X (deg/s),Magnetometer X (G)\n", "{i},{x},0.21"),
       {"--column 'magnetometer_x_uT=Magnetometer X (G):gauss'"}},
      // A PX4 module that logs its gyro and a FOG.
      {rows_of("Timestamp,Gyro_X,FOG_X\n", "1{i}0000,{x},{y}"),
       {"rate_x_radps=Gyro_X", "rate_x_radps=FOG_X"}},
      // rostopic echo, and loggers that write objects in objects.
      {"header: \n  seq: 0\n---\nheader: \n  seq: 1\n---\n", {"rostopic echo -p"}},
      {rows_of("", R"({"ts": 17.{i}, "gyro": {"x": {x}, "y": {y}, "z": {z}}})"), {"jq -r"}},
      // Gyroflow, gcsv 1.3, whose head looks like a table, and Epson's logger: the scale of counts stands above.
      {rows_of(
           "GYROFLOW IMU LOG\nid,custom\nvendor,cam\nversion,1.3\ntscale,0.001\ngscale,0.00122\nt,gx,gy,gz\n",
           "{i},{count},{count},{count}"),
       {"read as: time 't' in 0.001s, rate_x 'gx' in 0.00122 rad/s, rate_y 'gy' in 0.00122 rad/s"}},
      {rows_of("Gyro_SF=0.0151515 Accel_SF=0.4\nSample No,time,Gx,Gy\n", "{i},1.{i},{count},{count}"),
       {"rate_x 'Gx' in 0.0151515 deg/s"}},
      // Sensor Logger, a list of objects.
      {rows_of(
           "",
           R"({"sensor": "Gyroscope", "time": "17676204673{i}0000000", "x": "{x}", "y": "{y}", "z": "{z}"},)"),
       {"--time time:ns --column rate_x_radps=x:rad/s --column rate_y_radps=y:rad/s"}},
      // Spreadsheets of both orders.
      {rows_of("time,gyro_x_dps\n", "05/06/2023 12:00:00.{i},{x}"), {"read with the month first"}},
  };
  for (const Case& each : cases) {
    std::string all;
    try {
      for (const std::string& notice : parse_capture(each.text, "a.csv").notices) all += notice + "\n";
    } catch (const std::runtime_error& error) {
      all = error.what();
    }
    for (const std::string& part : each.said)
      EXPECT_NE(all.find(part), std::string::npos) << part << "\nnot in\n"
                                                   << all << "\nof\n"
                                                   << each.text.substr(0, 300);
  }
}

// A day above 12 says the order of all rows; one that contradicts it later is no row.
TEST(CsvLayout, RowsDecideWhatIsTheDay) {
  const auto read = [](const std::string& day, const std::string& next) {
    return parse_capture(
        rows_of("t,gyro_x_dps\n", day + " 23:59:59.{i},{x}", 400) + next + " 00:00:00.1,0.1\n", "a.csv");
  };
  EXPECT_EQ(read("13/06/2023", "14/06/2023").origin.s, 1686700799);
  EXPECT_EQ(read("13/06/2023", "14/06/2023").faults.size() + read("2023-06-12", "2023-06-13").faults.size(),
            0U);
  EXPECT_EQ(read("12/06/2023", "13/06/2023").faults.at(0),
            "a.csv:402: t is '13/06/2023 00:00:00.1', expected day and month in the order of the rows above; "
            "write the dates as year-month-day; this line is left out");
}

TEST(CsvLayout, TheOptionThatIsPrintedKeepsTheScale) {
  EXPECT_EQ(refusal([] { parse_capture("a,b\n1,2\n", "a.csv", layout({"rate_radps=b:12.5deg/s"})); }),
            "a.csv:1: no time column; to read it: --sample-rate HZ --column rate_radps=b:12.5deg/s");
}

}  // namespace
}  // namespace ifog
