// SPDX-License-Identifier: Apache-2.0
// The driver `dbc`: frames that come twice, samples that stay unfinished, files with bad lines; every loss is
// counted.
#include "tests/unit/drivers/dbc_frames.h"
#include "tests/unit/drivers/decoded.h"
#include "tests/unit/test.h"

namespace {

using ifog::DbcText;
using ifog::frame;

// Axis 0, 1 or 2 of ifogd_gyro.dbc.
ifog_can_frame axis(int which, float rate, int counter) {
  return ifog::axis_frame(256U + static_cast<std::uint32_t>(which), rate,
                          static_cast<std::uint16_t>(counter));
}

class Samples : public testing::Test {
 protected:
  void feed(const std::vector<ifog_can_frame>& frames) {
    for (const ifog_can_frame& f : frames)
      driver_.decode_can(f, [&](const ifog_sample& sample) { samples_.push_back(sample); });
  }
  ifog::DriverInstance driver_ = ifog::three_axes();
  std::vector<ifog_sample> samples_;
};

// 30 samples, each frame of them doubled in turn, at once or behind the next frames.
TEST_F(Samples, AFrameThatComesTwiceCostsNothingAndIsCounted) {
  std::uint64_t doubled = 0;
  for (std::size_t distance : {0U, 1U, 2U}) {
    std::vector<ifog_can_frame> frames;
    for (int k = 0; k < 30; ++k)
      for (int a = 0; a < 3; ++a) frames.push_back(axis(a, static_cast<float>(k * 10 + a), k + 100));
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

const std::string kGood = "BO_ 1 A: 8 X\n SG_ R : 0|16@1- (1,0) [0|0] \"deg/s\" X\n";
const std::string kOneBad = kGood + " SG_ Q : 0|1x@1- (1,0) [0|0] \"deg/s\" X\n";

TEST_F(DbcText, WithABadLineIsUsedAndTheLineNamed) {
  const std::string flaw = ":3: 'x@1- (1,0) [0|0] \"deg/s\"… (26 bytes)', expected '@'";
  const ifog::DriverInstance d = driver(kOneBad, {{"signal", "R"}});
  ASSERT_EQ(d.warnings().size(), 1U);
  EXPECT_TRUE(d.warnings()[0].ends_with(flaw)) << d.warnings()[0];
  EXPECT_TRUE(driver(kGood, {{"signal", "R"}}).warnings().empty());
  // A signal from a bad line is refused with the line.
  EXPECT_EQ(refusal(kOneBad, {{"signal", "Q"}}), "driver dbc: F" + flaw);
  EXPECT_EQ(refusal(kGood + " SG_ 3Q : 0|16@1- (1,0)\n", {{"signal", "Q"}}),
            "driver dbc: signal is 'Q', expected a signal of F: A.R; 1 bad lines in it, the first: "
            "F:3: '3Q : 0|16@1- (1,0)', expected the name of a signal");
}

// Three messages, in any order of their ids, jittered, one in eleven lost, a counter in one of them or none: each
// value is its cycle's number, and no sample waits for the next cycle.
TEST_F(DbcText, FramesThatArriveTogetherAreOneSample) {
  std::string text;
  for (const char* id : {"1", "2", "3"})
    text += "BO_ " + std::string(id) + " M" + id + ": 8 X\n SG_ R" + id +
            " : 0|8@1+ (1,0) [0|0] \"rad/s\" X\n" + " SG_ N" + id + " : 8|8@1+ (1,0) [0|0] \"\" X\n";
  constexpr std::int64_t kCycle_ns = 5'000'000, kFrame_ns = 300'000, kBegin_ns = 1'000'000'000;
  for (const char* counter : {"", "N1", "N2"}) {
    std::array<int, 3> order{1, 2, 3};
    do {
      ifog::DriverInstance d = driver(text, {{"x", "R1"}, {"y", "R2"}, {"z", "R3"}, {"counter", counter}});
      std::vector<ifog_can_frame> sent;
      std::size_t complete = 0;
      for (int k = 0; k < 250; ++k) {
        std::int64_t at_ns = kBegin_ns + k * kCycle_ns + k * 7919 % 1000 * 1000;
        std::size_t before = sent.size();
        for (const int id : order) {
          at_ns += kFrame_ns + k * 104'729 % 100 * 1000;
          if (k > 5 && (k * 3 + id) % 11 == 0) continue;
          sent.push_back(frame(static_cast<std::uint32_t>(id), {k, k}, at_ns));
        }
        complete += sent.size() == before + 3 ? 1 : 0;
      }
      const std::vector<ifog_sample> got = decode(d, sent);
      EXPECT_GE(got.size() + 1, complete) << order[0] << order[1] << order[2] << counter;
      for (const ifog_sample& one : got) {
        ASSERT_TRUE(one.value[0] == one.value[1] && one.value[1] == one.value[2]) << order[0] << order[1];
        ASSERT_LT(static_cast<double>(one.arrival_ns - kBegin_ns), (one.value[0] + 0.6) * kCycle_ns);
      }
    } while (std::next_permutation(order.begin(), order.end()));
  }
}

TEST_F(DbcText, ManyBadLinesAreCountedInTheLastWarning) {
  std::string text = kOneBad;
  for (int i = 0; i < 500; ++i) text += "?? what\n";
  const ifog::DriverInstance d = driver(text, {{"signal", "R"}});
  ASSERT_EQ(d.warnings().size(), 4U);
  EXPECT_EQ(d.warnings()[3], "driver dbc: 498 more bad lines, of signals that are not used");
}

// Yaw rate of Volkswagen's ESC_50 (opendbc) and of its ESP_02, whose sign is in a bit of its own: 12.34 °/s.
TEST_F(DbcText, ASignBitMakesTheRateNegative) {
  for (const auto& [name, sign] :
       {std::pair("Yaw_Rate", "Yaw_Rate_Sign"), {"ESP_Gierrate", "ESP_VZ_Gierrate"}}) {
    const std::string text = "BO_ 1 E: 8 X\n SG_ " + std::string(name) +
                             " : 40|14@1+ (0.01,0) [0|163.82] \"deg/s\" X\n SG_ " + sign +
                             " : 54|1@0+ (1,0) [0|1] \"\" X\n";
    const std::vector<ifog_can_frame> frames{frame(1, {0, 0, 0, 0, 0, 0xD2, 0x04, 0}),
                                             frame(1, {0, 0, 0, 0, 0, 0xD2, 0x44, 0})};
    ifog::DriverInstance d = driver(text, {{"signal", name}});
    ASSERT_EQ(d.warnings().size(), 1U);
    EXPECT_TRUE(ifog::test::has(d.warnings()[0], "is negative where " + std::string(sign)));
    const std::vector<ifog_sample> samples = decode(d, frames);
    ASSERT_EQ(samples.size(), 2U);
    EXPECT_NEAR(samples[0].value[0], 12.34 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_EQ(samples[1].value[0], -samples[0].value[0]);
    for (std::size_t i = 0; i < 2; ++i) {
      std::vector<ifog_can_frame> sent;
      d.encode_can(samples[i], sent);
      ASSERT_EQ(sent.size(), 1U);
      EXPECT_TRUE(std::equal(sent[0].data, sent[0].data + 8, frames[i].data)) << i;
    }
    ifog::DriverInstance as_sent = driver(text, {{"signal", name}, {"sign", "none"}});
    EXPECT_TRUE(as_sent.warnings().empty());
    const std::string misspelt = refusal(text, {{"signal", std::string(name).substr(1)}});
    EXPECT_TRUE(ifog::test::has(misspelt, "did you mean '" + std::string(name) + "'?"));
    EXPECT_EQ(decode(as_sent, frames)[1].value[0], samples[0].value[0]);
  }
}

TEST(DbcDriver, ADeviceIsNotRead) {
  EXPECT_EQ(ifog::refusal("dbc", {{"dbc", "/dev/zero"}, {"signal", "R"}}),
            "driver dbc: dbc is '/dev/zero', expected a regular file");
}

}  // namespace
