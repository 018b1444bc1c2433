// SPDX-License-Identifier: Apache-2.0
// A capture whose times are large numbers: they are told, cut and written as they stand in it.
#include <gtest/gtest.h>
#include <unistd.h>

#include <filesystem>

#include "drivers/capture/text_file.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/capture_output.h"

namespace ifog::tools {
namespace {

// Stamps of a clock that is not quite even, with all the digits that they may have.
const std::string kCapture =
    "time_s,rate_radps\n"
    "1700000000.123456789,0.5\n"
    "1700000000.133456788,0.25\n"
    "1700000000.2,0.125\n"
    "1700000001,-0.5\n"
    "1700086400.000000001,1\n";

LongTable table_of(const std::string& text) {
  InputFile file("a.csv", text);
  return CaptureInput().read_long(file);
}

std::string written(const LongTable& table) {
  const auto path =
      std::filesystem::temp_directory_path() / ("epoch_times_" + std::to_string(getpid()) + ".csv");
  write_columns(table, "a.csv", path.string());
  const std::string text = read_text_file(path.string());
  std::filesystem::remove(path);
  return text;
}

TEST(EpochTimes, AreWrittenWithTheDigitsTheyCameWith) {
  EXPECT_EQ(written(table_of(kCapture)), kCapture);
  const std::string negative = "time_s,rate_radps\n-2000.75,1\n-1999.25,2\n-0.125,3\n0,4\n0.0625,5\n7.5,6\n";
  EXPECT_EQ(written(table_of(negative)), negative);
}

TEST(EpochTimes, ArePartedByWhatTheySay) {
  LongCapture capture(table_of(kCapture), "a.csv");
  TimePart part;
  part.from_s = 1700000000.2;
  part.to_s = 1700000001.5;
  const CaptureView inside = capture.part(part, "a.csv");
  ASSERT_EQ(inside.size(), 2U);
  EXPECT_EQ(inside.told_time_s(0), 1700000000.2);
  EXPECT_EQ(inside.told_time_s(1), 1700000001.0);
  capture.count_from_zero();
  EXPECT_EQ(capture.view().origin_s, 0);
  EXPECT_EQ(capture.view().time_s[2], 1700000000.2);
  EXPECT_EQ(capture.part(part, "a.csv").size(), 2U);
  part.to_s = 1700000000.2;
  try {
    (void)capture.part(part, "a.csv");
    FAIL();
  } catch (const std::runtime_error& error) {
    EXPECT_NE(std::string(error.what()).find("1700000000 … 1700086400 s"), std::string::npos) << error.what();
  }
}

}  // namespace
}  // namespace ifog::tools
