// SPDX-License-Identifier: Apache-2.0
#include <sys/resource.h>
#include <zlib.h>

#include "drivers/capture/columns/column_names.h"
#include "drivers/capture/csv/csv_writer.h"
#include "drivers/capture/files/input_file.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

namespace fs = std::filesystem;

Capture capture_in(const std::string& text) { return parse_capture(text, "a.csv"); }

TEST(CaptureText, SortsColumnsByTheirNames) {
  const Capture c = capture_in(
      "# a gyro\ntime_s,rate_x_radps,rate_y_radps,reference_rate_y_radps,temperature_degC\n"
      "0,1e-3,2,3,25.5\n0.5,,nan,+4,\n");
  EXPECT_EQ(c.comments, std::vector<std::string>{"a gyro"});
  EXPECT_EQ(c.axes, (std::vector<std::string>{"x", "y"}));
  EXPECT_EQ(c.time_s, (std::vector<double>{0.0, 0.5}));
  EXPECT_EQ(c.rate_radps[0][0], 1e-3);
  EXPECT_TRUE(std::isnan(c.rate_radps[0][1]));
  EXPECT_TRUE(std::isnan(c.rate_radps[1][1]));
  EXPECT_TRUE(c.reference_rate_radps[0].empty());
  EXPECT_EQ(c.reference_rate_radps[1], (std::vector<double>{3.0, 4.0}));
  ASSERT_EQ(c.channels.size(), 1U);
  EXPECT_EQ(c.channels[0].name, "temperature_degC");
}

TEST(CaptureText, RefusesWithFileLineValueAndExpectation) {
  EXPECT_EQ(refusal_of("rate_radps\n1\n"),
            "a.csv:1: no time column; to read it: --sample-rate HZ --column rate_radps=rate_radps:radps");
  EXPECT_EQ(refusal_of("time_s,temperature_degC\n0,1\n"),
            "a.csv:1: no rate column among 'temperature_degC', expected 'rate_radps' or 'rate_x_radps', …, "
            "or --column "
            "rate_x_radps=NAME:UNIT with one of these names");
  EXPECT_EQ(refusal_of("time_s,rate_radps\n0,1\n1,1x\n"),
            "a.csv:3: rate_radps is '1x', expected a number, 'nan' or nothing");
  EXPECT_EQ(refusal_of("time_s,rate_radps\n"), "a.csv: no rows after the header");
}

// What R, pandas, databases and spreadsheets make of a missing value, and of the end of a row.
TEST(CaptureText, WordsForNoValueAndSeparatorsAtTheEnd) {
  for (const std::string word : {"NA", "na", "N/A", "#N/A", "null", "NULL", "None", "-", "NaN", ""})
    for (const std::string header_end : {"", ",", ", "})
      for (const std::string row_end : {"", ",", ", "}) {
        const Capture c = capture_in("time_s,rate_radps,temperature_degC" + header_end + "\n0,1," + word +
                                     row_end + "\n1," + word + ",7" + row_end + "\n2,3,8\n");
        ASSERT_EQ(c.size(), 3U) << word;
        EXPECT_TRUE(std::isnan(c.rate_radps[0][1])) << word;
        ASSERT_EQ(c.channels.size(), 1U) << word;
        EXPECT_TRUE(std::isnan(c.channels[0].values[0])) << word;
        EXPECT_EQ(c.channels[0].values[1], 7.0) << word;
      }
  EXPECT_EQ(refusal_of("time_s,rate_radps\n0,1\n1,NAN1\n"),
            "a.csv:3: rate_radps is 'NAN1', expected a number, 'nan' or nothing");
  EXPECT_EQ(refusal_of("time_s,rate_radps\n0,1,,\n"), "a.csv:2: more cells than the 2 columns of the header");
  EXPECT_EQ(refusal_of("time_s,rate_radps,\n0,1,5\n"),
            "a.csv:2: more cells than the 2 columns of the header");
  EXPECT_EQ(refusal_of("time_s,rate_radps\nNA,1\n"), "a.csv:2: time_s is missing, expected a time");
}

TEST(CaptureText, GzipReadsBackTheSameBitsAndATruncatedOneAsFarAsItGoes) {
  std::vector<double> time_s, rate_radps;
  for (int i = 0; i < 5000; ++i) {
    time_s.push_back(i / 3.0);
    rate_radps.push_back(std::sin(i * 0.7) * 1e-5);
  }
  const test::OwnFolder folder;
  const std::string name = folder.path("a.csv.gz");
  const std::string channel = "temperature, inner_degC";
  CsvWriter file(name, "", {"time_s", "rate_radps", channel});
  file.rows(std::vector<std::span<const double>>{time_s, rate_radps, time_s});
  file.finish();
  const Capture back = read_capture(name);
  EXPECT_EQ(back.channels.at(0).name, channel);
  EXPECT_EQ(back.time_s, time_s);
  EXPECT_EQ(back.rate_radps[0], rate_radps);
  fs::resize_file(name, fs::file_size(name) / 2);
  const Capture cut = read_capture(name);
  ASSERT_GT(cut.size(), 1000U);
  ASSERT_LT(cut.size(), 4000U);
  for (std::size_t i = 0; i + 1 < cut.size(); ++i) EXPECT_EQ(cut.rate_radps[0][i], rate_radps[i]);
  ASSERT_FALSE(cut.faults.empty());
  EXPECT_EQ(cut.faults.back(),
            name + ": the gzip stream ends early (truncated file); the rows until there are read");
}

// What a hostile file may cost: a line, a cell, a name or an unpacked stream of any size is refused with one
// short line.
class HostileFile : public testing::Test, protected test::OwnFolder {
 protected:
  template <typename Read>
  std::string refusal(Read&& read) {
    const std::string what = test::refusal([&] { (void)read(path_); });
    return what.starts_with(path_) ? what.substr(path_.size()) : what;
  }
  // `times` times the block, packed: gigabytes on some hundred kilobytes.
  void pack(const std::string& block, int times) {
    gzFile file = gzopen(path_.c_str(), "wb1");
    for (int i = 0; i < times; ++i) gzwrite(file, block.data(), static_cast<unsigned>(block.size()));
    gzclose(file);
  }
  const std::string path_ = path("hostile");
};

TEST_F(HostileFile, ALongCellIsNamedAndNotEchoed) {
  std::ofstream(path_) << "time_s,rate_radps\n0,1\n1,x" << std::string(900'000, '7') << "\n";
  EXPECT_EQ(refusal(read_capture), ":3: rate_radps is 'x" + std::string(59, '7') +
                                       "… (900001 bytes)', expected a number, 'nan' or nothing");
  std::ofstream(path_) << "time_s,rate_radps\n0,\x1b[2J\x07\n";
  EXPECT_EQ(refusal(read_capture), ":2: rate_radps is '\\x1b[2J\\x07', expected a number, 'nan' or nothing");
  std::ofstream(path_) << std::string(100'000, 'n') << ",rate_radps\n0,1\n";
  EXPECT_LT(refusal(read_capture).size(), 200U);
}

TEST_F(HostileFile, AGzipBombStopsAtItsFirstLine) {
  pack(std::string(1U << 20U, '0'), 256);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  EXPECT_EQ(refusal(read_capture).substr(0, 36), ":1: a line of more than 1048576 byte");
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 50'000);  // KiB
}

TEST_F(HostileFile, AGzipBombOfShortLinesStopsToo) {
  std::string lines;
  while (lines.size() < 1U << 20U) lines += "#\n";
  pack(lines, 300);
  const std::string said =
      ": grows to more than 256 MiB, 100 times its size, when unpacked, expected a recording";
  EXPECT_EQ(refusal(read_capture), said);
  EXPECT_EQ(refusal(read_whole_file), said);
  pack(lines, 200);
  EXPECT_EQ(read_whole_file(path_).size(), 200 * lines.size());
}

// A wide header over short rows must not ask for rows × columns before it has seen them.
TEST_F(HostileFile, AWideHeaderReservesNoMemory) {
  std::string text = "time_s,rate_radps";
  for (int i = 0; i < 4'000; ++i) text += ",c" + std::to_string(i);
  text += "\n0\n";
  for (int i = 0; i < 2'000'000; ++i) text += "1\n";
  std::ofstream(path_) << text;
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  EXPECT_EQ(refusal(read_capture), ":2: 1 cells, expected 4002 (a truncated line?)");
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 200'000);
}

// One cell that no sensor can have measured is missing; it neither refuses the capture nor stays in it.

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
    EXPECT_TRUE(test::has(table.faults[0], "1 such cell treated as missing"));
  }
  const Capture read = parse_capture(capture("rate_radps,accel_x_mps2", 2, 3, 0, "1e30"), "a.csv");
  EXPECT_TRUE(std::isnan(read.rate_radps[0][3]));
  EXPECT_EQ(read.faults.size(), 1U);
}

// What a sensor may well say stays, however odd; the limit is that of the unit in the file: 5000 °F are 2760 °C.
TEST(Measurable, WhatMayBeMeasuredStays) {
  const auto read = [](const std::string& unit, const std::string& cell) {
    CsvLayout layout;
    layout.columns = {CsvColumn::parse("rate_radps=w:rad/s"), CsvColumn::parse("temperature_degC=T:" + unit)};
    layout.time = CsvTime::parse("time_s:s");
    return parse_capture(capture("w,T", 2, 50, 1, cell), "a.csv", layout).channels[0].values[50];
  };
  for (const char* const cell : {"85", "-127", "-273.15", "1200"})
    EXPECT_EQ(read("degC", cell), std::stod(cell));
  EXPECT_NEAR(read("degF", "5000"), 2760.0, 1e-9);
  EXPECT_TRUE(std::isnan(read("degF", "9000")));
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
