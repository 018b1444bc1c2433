// SPDX-License-Identifier: Apache-2.0
// What a hostile file may cost: a line, a cell, a name or an unpacked stream of any size is refused with one
// short line.
#include "drivers/capture/files/text_file.h"

#include <gtest/gtest.h>
#include <sys/resource.h>
#include <unistd.h>
#include <zlib.h>

#include <algorithm>
#include <filesystem>
#include <fstream>
#include <stdexcept>
#include <string>

#include "drivers/capture/capture.h"

namespace {

namespace fs = std::filesystem;

ifog::Capture read_by_name(const std::string& path) { return ifog::read_capture(path); }

class HostileFile : public testing::Test {
 protected:
  void SetUp() override { path_ = fs::temp_directory_path() / ("ifog-hostile-" + std::to_string(getpid())); }
  void TearDown() override { fs::remove(path_); }
  template <typename Read>
  std::string refusal(Read&& read) {
    try {
      (void)read(path_.string());
    } catch (const std::exception& error) {
      const std::string what = error.what();
      return what.starts_with(path_.string()) ? what.substr(path_.string().size()) : what;
    }
    return "accepted";
  }
  // `times` times the block, packed: gigabytes on some hundred kilobytes.
  void pack(const std::string& block, int times) {
    gzFile file = gzopen(path_.c_str(), "wb1");
    for (int i = 0; i < times; ++i) gzwrite(file, block.data(), static_cast<unsigned>(block.size()));
    gzclose(file);
  }
  fs::path path_;
};

TEST_F(HostileFile, ALongCellIsNamedAndNotEchoed) {
  std::ofstream(path_) << "time_s,rate_radps\n0,1\n1,x" << std::string(900'000, '7') << "\n";
  EXPECT_EQ(refusal(read_by_name), ":3: rate_radps is 'x" + std::string(59, '7') +
                                       "… (900001 bytes)', expected a number, 'nan' or nothing");
  std::ofstream(path_) << "time_s,rate_radps\n0,\x1b[2J\x07\n";
  EXPECT_EQ(refusal(read_by_name), ":2: rate_radps is '\\x1b[2J\\x07', expected a number, 'nan' or nothing");
  std::ofstream(path_) << std::string(100'000, 'n') << ",rate_radps\n0,1\n";
  EXPECT_LT(refusal(read_by_name).size(), 200U);
}

TEST_F(HostileFile, AGzipBombStopsAtItsFirstLine) {
  pack(std::string(1U << 20U, '0'), 256);
  rusage before{}, after{};
  getrusage(RUSAGE_SELF, &before);
  EXPECT_EQ(refusal(read_by_name).substr(0, 36), ":1: a line of more than 1048576 byte");
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 50'000);  // KiB
}

TEST_F(HostileFile, AGzipBombOfShortLinesStopsToo) {
  std::string lines;
  while (lines.size() < 1U << 20U) lines += "#\n";
  pack(lines, 300);
  EXPECT_EQ(refusal(read_by_name),
            ": grows to more than 256 MiB, 100 times its size, when unpacked, expected a "
            "recording");
  EXPECT_EQ(refusal(ifog::read_whole_file),
            ": grows to more than 256 MiB, 100 times its size, when unpacked, expected a "
            "recording");
  pack(lines, 200);
  EXPECT_EQ(ifog::read_whole_file(path_.string()).size(), 200 * lines.size());
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
  EXPECT_EQ(refusal(read_by_name), ":2: 1 cells, expected 4002 (a truncated line?)");
  getrusage(RUSAGE_SELF, &after);
  EXPECT_LT(after.ru_maxrss - before.ru_maxrss, 200'000);
}

}  // namespace
