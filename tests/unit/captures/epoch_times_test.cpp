// SPDX-License-Identifier: Apache-2.0
// A capture whose times are large numbers: they are told, cut and written as they stand in it.
#include <gtest/gtest.h>

#include "drivers/capture/files/input_file.h"
#include "tests/unit/own_folder.h"
#include "tests/unit/refusal.h"
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

std::string written(const LongTable& table, const std::string& ending = ".csv") {
  const test::OwnFolder folder;
  const std::string path = folder.path("times" + ending);
  write_columns(table, "a.csv", path);
  return read_whole_file(path);
}

TEST(EpochTimes, AreWrittenWithTheDigitsTheyCameWith) {
  EXPECT_EQ(written(table_of(kCapture)), kCapture);
  const std::string negative = "time_s,rate_radps\n-2000.75,1\n-1999.25,2\n-0.125,3\n0,4\n0.0625,5\n7.5,6\n";
  EXPECT_EQ(written(table_of(negative)), negative);
}

TEST(EpochTimes, GoThroughHdf5WithAllOfThem) {
  InputFile packed("a.h5", written(table_of(kCapture), ".h5"));
  CaptureInput input;
  EXPECT_EQ(written(input.read_long(packed)), kCapture);
  // By chosen columns, too.
  InputFile chosen("a.h5", written(table_of(kCapture), ".h5"));
  input.columns = {"rate_radps=rate_radps"};
  EXPECT_EQ(written(input.read_long(chosen)), kCapture);
}

TEST(EpochTimes, ArePartedByWhatTheySay) {
  LongCapture capture(table_of(kCapture), "a.csv");
  TimePart part;
  const auto set = [](TimePart::Bound& bound, const std::string& text) {
    bound = {*SaidTime::parse(text), text};
  };
  set(part.from, "1700000000.2");
  set(part.to, "1700000001.5");
  const CaptureView inside = capture.part(part, "a.csv");
  ASSERT_EQ(inside.size(), 2U);
  EXPECT_EQ(inside.shown_time_s(0), 1700000000.2);
  EXPECT_EQ(inside.shown_time_s(1), 1700000001.0);
  // By digits that a double of that size does not have.
  set(part.from, "1700000000.133456788");
  EXPECT_EQ(capture.part(part, "a.csv").size(), 3U);
  set(part.from, "1700000000.133456789");
  EXPECT_EQ(capture.part(part, "a.csv").size(), 2U);
  set(part.to, "1700000000.2");
  EXPECT_NE(
      test::refusal([&] { (void)capture.part(part, "a.csv"); }).find("1700000000.123457 … 1700086400 s"),
      std::string::npos);
}

}  // namespace
}  // namespace ifog::tools
