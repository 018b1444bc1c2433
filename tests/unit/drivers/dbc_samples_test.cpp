// SPDX-License-Identifier: Apache-2.0
// The driver `dbc`: frames that come twice, samples that stay unfinished, files with bad lines; every loss is
// counted.
#include <gtest/gtest.h>
#include <unistd.h>

#include <bit>
#include <filesystem>
#include <fstream>
#include <vector>

#include "drivers/host/driver_instance.h"

namespace {

namespace fs = std::filesystem;

const std::string kBus = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/ifogd_gyro.dbc";

// Axis 0, 1 or 2: little-endian float, 16-bit counter.
ifog_can_frame axis(int which, float rate, std::uint16_t counter) {
  ifog_can_frame f{};
  f.id = 256U + static_cast<std::uint32_t>(which);
  f.length = 8;
  const auto bits = std::bit_cast<std::uint32_t>(rate);
  for (unsigned i = 0; i < 4; ++i) f.data[i] = static_cast<std::uint8_t>(bits >> 8U * i);
  f.data[4] = static_cast<std::uint8_t>(counter);
  f.data[5] = static_cast<std::uint8_t>(counter >> 8U);
  return f;
}

class Samples : public testing::Test {
 protected:
  void feed(const std::vector<ifog_can_frame>& frames) {
    for (const ifog_can_frame& f : frames)
      driver_.decode_can(f, [&](const ifog_sample& sample) { samples_.push_back(sample); });
  }
  ifog::DriverInstance driver_ = ifog::make_driver(
      "dbc", {{"dbc", kBus}, {"x", "Rate_x"}, {"y", "Rate_y"}, {"z", "Rate_z"}, {"counter", "Counter"}});
  std::vector<ifog_sample> samples_;
};

// 30 samples, each frame of them doubled in turn, at once or behind the next frames.
TEST_F(Samples, AFrameThatComesTwiceCostsNothingAndIsCounted) {
  std::uint64_t doubled = 0;
  for (std::size_t distance : {0U, 1U, 2U}) {
    std::vector<ifog_can_frame> frames;
    for (int k = 0; k < 30; ++k)
      for (int a = 0; a < 3; ++a)
        frames.push_back(axis(a, static_cast<float>(k * 10 + a), static_cast<std::uint16_t>(k + 100)));
    // From the end on, so that the places in front stay.
    for (std::size_t i = 80; i >= 6; i -= 7) {
      frames.insert(frames.begin() + static_cast<std::ptrdiff_t>(i + 1 + distance), frames[i]);
      ++doubled;
      if (i < 13) break;
    }
    samples_.clear();
    driver_.reset();
    feed(frames);
    ASSERT_EQ(samples_.size(), 30U) << distance;
    for (int k = 0; k < 30; ++k)
      for (int a = 0; a < 3; ++a) ASSERT_EQ(samples_[static_cast<std::size_t>(k)].value[a], k * 10 + a);
  }
  driver_.reset();
  EXPECT_EQ(driver_.counters().frames_repeated, doubled);
  EXPECT_EQ(driver_.counters().samples_incomplete, 0U);
  EXPECT_EQ(driver_.counters().frames_good, 3 * 90 + doubled);
}

// A counter that stands still does not make two samples one.
TEST_F(Samples, ACounterThatStandsStillTellsNothing) {
  feed({axis(0, 1, 5), axis(1, 2, 5), axis(2, 3, 5), axis(0, 1, 5), axis(1, 7, 5), axis(2, 8, 5)});
  ASSERT_EQ(samples_.size(), 2U);
  EXPECT_EQ(samples_[1].value[0], 1.0);
  EXPECT_EQ(samples_[1].value[1], 7.0);
  EXPECT_EQ(driver_.counters().frames_repeated, 0U);
}

TEST_F(Samples, TheUnfinishedLastSampleIsCounted) {
  feed({axis(0, 1, 1), axis(1, 2, 1), axis(2, 3, 1), axis(0, 4, 2), axis(1, 5, 2)});
  EXPECT_EQ(samples_.size(), 1U);
  EXPECT_EQ(driver_.counters().samples_incomplete, 0U);
  driver_.reset();  // the log has ended
  EXPECT_EQ(driver_.counters().samples_incomplete, 1U);
  driver_.reset();
  EXPECT_EQ(driver_.counters().samples_incomplete, 1U);
}

class BadFile : public testing::Test {
 protected:
  void SetUp() override {
    path_ = fs::temp_directory_path() / ("ifog-bad-" + std::to_string(getpid()) + ".dbc");
  }
  void TearDown() override { fs::remove(path_); }
  ifog::DriverInstance driver(const std::string& text, const std::string& signal) {
    std::ofstream(path_, std::ios::binary) << text;
    return ifog::make_driver("dbc", {{"dbc", path_.string()}, {"signal", signal}});
  }
  std::string refusal(const std::string& text, const std::string& signal) {
    try {
      driver(text, signal);
    } catch (const std::runtime_error& error) {
      return error.what();
    }
    return "accepted";
  }
  fs::path path_;
};

const std::string kOneBad =
    "BO_ 1 A: 8 X\n SG_ R : 0|16@1- (1,0) [0|0] \"deg/s\" X\n SG_ Q : 0|1x@1- (1,0) [0|0] \"deg/s\" X\n";

TEST_F(BadFile, IsUsedAndItsBadLineNamed) {
  const ifog::DriverInstance d = driver(kOneBad, "R");
  ASSERT_EQ(d.warnings().size(), 1U);
  EXPECT_EQ(d.warnings()[0],
            "driver dbc: " + path_.string() + ":3: 'x@1- (1,0) [0|0] \"deg/s\"… (26 bytes)', expected '@'");
  EXPECT_TRUE(driver("BO_ 1 A: 8 X\n SG_ R : 0|16@1- (1,0) [0|0] \"deg/s\" X\n", "R").warnings().empty());
}

TEST_F(BadFile, ASignalFromABadLineIsRefusedWithTheLine) {
  EXPECT_EQ(refusal(kOneBad, "Q"),
            "driver dbc: " + path_.string() + ":3: 'x@1- (1,0) [0|0] \"deg/s\"… (26 bytes)', expected '@'");
  EXPECT_EQ(refusal("BO_ 1 A: 8 X\n SG_ R : 0|16@1- (1,0) [0|0] \"deg/s\" X\n SG_ 3Q : 0|16@1- (1,0)\n", "Q"),
            "driver dbc: signal is 'Q', expected a signal of " + path_.string() +
                ": A.R; 1 bad lines in it, the first: " + path_.string() +
                ":3: '3Q : 0|16@1- (1,0)', expected the name of a signal");
}

TEST_F(BadFile, ManyWarningsAreCountedInTheLast) {
  std::string text = kOneBad;
  for (int i = 0; i < 500; ++i) text += "?? what\n";
  const ifog::DriverInstance d = driver(text, "R");
  ASSERT_GT(d.warnings().size(), 5U);
  ASSERT_LT(d.warnings().size(), 100U);
  EXPECT_EQ(d.warnings().back(),
            "driver dbc: and " + std::to_string(501 - (d.warnings().size() - 1)) + " more warnings");
}

TEST_F(BadFile, ADeviceIsNotRead) {
  try {
    ifog::make_driver("dbc", {{"dbc", "/dev/zero"}, {"signal", "R"}});
    ADD_FAILURE() << "accepted";
  } catch (const std::runtime_error& error) {
    EXPECT_STREQ(error.what(), "driver dbc: dbc is '/dev/zero', expected a regular file");
  }
}

}  // namespace
