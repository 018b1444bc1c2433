// SPDX-License-Identifier: Apache-2.0
// The driver `dbc`: signals picked by options, samples gathered from several frames, nothing made of two
// samples.
#include "drivers/host/timeline_frame.h"
#include "drivers/timeline/timeline.h"
#include "tests/unit/drivers/dbc_frames.h"
#include "tests/unit/test.h"

namespace {

using ifog::axis_frame;
using ifog::DbcText;
using ifog::decode;
using ifog::frame;
using ifog::kDbcExamples;
using ifog::three_axes;

TEST(DbcDriver, GoettingFrameByHand) {
  ifog::DriverInstance driver = ifog::make_driver("dbc", {{"dbc", kDbcExamples + "goetting_hg_g_84300.dbc"},
                                                          {"signal", "Angle"},
                                                          {"kind", "angle"},
                                                          {"counter", "Cycle"},
                                                          {"status", "Status"},
                                                          {"status_mask", "0x80"},
                                                          {"status_good", "0"},
                                                          {"environment", "temperature_degC=Temperature"},
                                                          {"rate_hz", "100"}});
  EXPECT_EQ(driver.description().kind, unsigned{IFOG_ANGLE});
  EXPECT_EQ(driver.description().sequence_modulus, 256U);
  EXPECT_EQ(driver.description().can_ids, 1U);
  EXPECT_EQ(driver.description().can_id[0].id, 389U);
  EXPECT_DOUBLE_EQ(driver.description().angle_wrap_rad, 2.0 * std::numbers::pi);
  // 0x3FC00000 = 1.5; -3 °C; status 0x10; cycle 200. Then the parameter error bit.
  const std::vector<ifog_sample> samples =
      decode(driver, {frame(389, {0, 0, 0xC0, 0x3F, 0xFD, 0xFF, 0x10, 200}, 77),
                      frame(389, {0, 0, 0xC0, 0x3F, 0xFD, 0xFF, 0x90, 201})});
  ASSERT_EQ(samples.size(), 2U);
  EXPECT_EQ(samples[0].value[0], 1.5);
  EXPECT_EQ(samples[0].arrival_ns, 77);
  EXPECT_EQ(samples[0].sequence, 200U);
  EXPECT_EQ(samples[0].status, 0x10U);
  EXPECT_EQ(samples[0].valid_axes, 1U);
  EXPECT_EQ(samples[0].environment[0], -3.0);
  EXPECT_EQ(samples[0].environment_fresh, 1U);
  EXPECT_EQ(samples[1].valid_axes, 0U);
}

// Each frame of a run is lost in turn: the samples that come out are exactly the ones that were complete.
TEST(DbcDriver, ALostFrameCostsItsSampleAndMixesNone) {
  for (const bool counted : {true, false})
    for (std::size_t lost = 0; lost < 15; ++lost) {
      ifog::DriverInstance driver = counted ? three_axes() : three_axes({});
      std::vector<ifog_can_frame> frames;
      for (int k = 0; k < 5; ++k)
        for (int axis = 0; axis < 3; ++axis)
          frames.push_back(axis_frame(static_cast<std::uint32_t>(256 + axis),
                                      static_cast<float>(10 * k + axis),
                                      static_cast<std::uint16_t>(65533 + k)));
      frames.erase(frames.begin() + static_cast<std::ptrdiff_t>(lost));
      std::vector<double> seen;
      for (const ifog_sample& s : decode(driver, frames)) {
        EXPECT_EQ(s.value[1], s.value[0] + 1.0);
        EXPECT_EQ(s.value[2], s.value[0] + 2.0);
        seen.push_back(s.value[0] / 10.0);
        if (counted) {
          EXPECT_EQ(s.sequence, static_cast<std::uint16_t>(65533 + static_cast<int>(seen.back())));
        }
      }
      std::vector<double> expected;
      for (int k = 0; k < 5; ++k)
        if (static_cast<std::size_t>(k) != lost / 3) expected.push_back(k);
      EXPECT_EQ(seen, expected) << "lost " << lost << (counted ? " with" : " without") << " counter";
      // A sample whose rest never came is only known to be incomplete when the next one begins, or the log
      // ends.
      driver.reset();
      if (lost != 12 || counted) {
        EXPECT_GE(driver.counters().samples_incomplete, 1U);
      }
    }
}

TEST(DbcDriver, IgnoresOtherIdsAndExtendedTwinsAndCountsShortFrames) {
  ifog::DriverInstance driver = three_axes();
  ifog_can_frame twin = axis_frame(256, 1.0F, 1);
  twin.flags = IFOG_CAN_EXTENDED;
  ifog_can_frame cut = axis_frame(256, 1.0F, 1);
  cut.length = 5;
  EXPECT_TRUE(decode(driver, {twin, axis_frame(999, 1.0F, 1), cut}).empty());
  EXPECT_EQ(driver.counters().frames_good, 0U);
  EXPECT_EQ(driver.counters().frames_other, 2U);
  EXPECT_EQ(driver.counters().frames_format, 1U);
}

TEST(DbcDriver, NaNIsInvalidAndLeavesTheOtherAxesValid) {
  ifog::DriverInstance driver = three_axes();
  const std::vector<ifog_sample> samples =
      decode(driver, {axis_frame(256, 1.0F, 1), axis_frame(257, std::nanf(""), 1), axis_frame(258, 3.0F, 1)});
  ASSERT_EQ(samples.size(), 1U);
  EXPECT_EQ(samples[0].valid_axes, 0b101U);
}

constexpr const char* kTwo =
    "BO_ 1 A: 8 X\n SG_ R : 0|16@1- (0.01,0) [0|0] \"deg/s\" X\n SG_ N : 16|4@1+ (1,0) [0|0] \"\" X\n"
    "BO_ 2 B: 8 X\n SG_ R : 0|16@1- (0.01,0) [0|0] \"furlong\" X\n SG_ T : 16|32@1+ (1,0) [0|0] \"us\" X\n";

TEST_F(DbcText, RefusalsNameKeyValueAndExpectation) {
  EXPECT_EQ(
      refusal(kTwo, {{"signal", "R"}}),
      "driver dbc: signal is 'R', expected one signal, with its message before a dot; 'R' may be A.R or B.R");
  EXPECT_EQ(refusal(kTwo, {{"signal", "Q"}}),
            "driver dbc: signal is 'Q', expected a signal of F: A.R, A.N, B.R, B.T");
  EXPECT_EQ(refusal(kTwo, {}),
            "driver dbc: signal is '', expected a signal here, or in x, y, z: A.R, A.N, B.R, B.T");
  EXPECT_EQ(
      refusal(kTwo, {{"signal", "B.R"}}),
      "driver dbc: unit is 'auto', expected a unit of angular rate (rad/s, deg/s, deg/h, …), as the DBC file "
      "gives 'furlong' for B.R");
  EXPECT_EQ(refusal(kTwo, {{"signal", "A.R"}, {"x", "A.R"}}),
            "driver dbc: x is 'A.R', expected nothing with 'signal': a sensor has either one axis without a "
            "name or x, y, z");
  EXPECT_EQ(
      refusal(kTwo, {{"signal", "A.R"}, {"counter", "B.T"}}),
      "driver dbc: counter is 'B.T', expected a signal in a message that carries an axis; B.T is in none");
  EXPECT_EQ(refusal("BO_ 1 A 8", {{"signal", "A.R"}}), "driver dbc: F:1: '8', expected ':'");
  EXPECT_EQ(
      refusal(kTwo, {{"signal", "A.R"}, {"environment", "T"}}),
      "driver dbc: environment is 'T', expected COLUMN=SIGNAL, several separated by commas; 'T' is not");
}

TEST_F(DbcText, UnitsCountersAndClocks) {
  ifog::DriverInstance a = driver(kTwo, {{"signal", "A.R"}, {"counter", "N"}, {"counter_modulus", "15"}});
  EXPECT_EQ(a.description().sequence_modulus, 15U);
  const std::vector<ifog_sample> s =
      decode(a, {frame(1, {0x9C, 0xFF, 14, 0, 0, 0, 0, 0})});  // -100 · 0.01 deg/s
  ASSERT_EQ(s.size(), 1U);
  EXPECT_DOUBLE_EQ(s[0].value[0], -std::numbers::pi / 180.0);
  EXPECT_EQ(s[0].sequence, 14U);

  ifog::DriverInstance b = driver(kTwo, {{"signal", "B.R"}, {"unit", "deg/h"}, {"time", "T"}});
  EXPECT_EQ(b.description().has_device_time, 1U);
  const std::vector<ifog_sample> t =
      decode(b, {frame(2, {0, 0, 0x00, 0xFF, 0xFF, 0xFF, 0, 0}),    // 2^32 - 256 µs
                 frame(2, {1, 0, 0x00, 0x01, 0x00, 0x00, 0, 0})});  // 256 µs later still
  ASSERT_EQ(t.size(), 2U);
  EXPECT_EQ(t[0].device_time_ns, ((std::int64_t{1} << 32U) - 256) * 1000);
  EXPECT_EQ(t[1].device_time_ns, 256'000);
  EXPECT_EQ(t[1].device_wrap_ns, (std::int64_t{1} << 32U) * 1000);
  EXPECT_DOUBLE_EQ(t[1].value[0], 0.01 * std::numbers::pi / 180.0 / 3600.0);
}

// Eight bits of a millisecond each, at 125 Hz: the clock rolls over within 32 samples.
TEST_F(DbcText, HowOftenAClockWentRoundInAGapTheTimesOfArrivalSay) {
  const std::string text =
      "BO_ 2 B: 8 X\n SG_ R : 0|16@1- (0.01,0) [0|0] \"deg/s\" X\n SG_ T : 16|8@1+ (1,0) [0|0] \"ms\" X\n";
  ifog::DriverInstance b = driver(text, {{"signal", "B.R"}, {"time", "T"}, {"rate_hz", "125"}});
  EXPECT_EQ(b.description().has_device_time, 1U);
  ifog::Timeline timeline(0, 125.0);
  std::int64_t taken = 0, last_ns = 0;
  const auto step_ns = [&](std::int64_t samples) {
    taken += samples;
    ifog_can_frame sent = frame(2, {1, 0, static_cast<std::uint8_t>(taken * 8), 0, 0, 0, 0, 0});
    sent.arrival_ns = 1'000'000'000 + taken * 8'000'000;
    const std::vector<ifog_sample> got = decode(b, {sent});
    EXPECT_EQ(got.size(), 1U);
    const ifog::Timeline::Frame one = ifog::timeline_frame(got.front(), 1);
    const std::int64_t now_ns = taken > 1 ? timeline.next(one).time_ns : timeline.first(one);
    return now_ns - std::exchange(last_ns, now_ns);
  };
  step_ns(1);
  for (const std::int64_t samples : {1, 21, 1, 41, 1, 1, 301, 1, 34, 2})
    EXPECT_EQ(step_ns(samples), samples * 8'000'000);
}

TEST_F(DbcText, AnIntegerAngleWrapsAtItsRange) {
  const std::string text = "BO_ 1 A: 8 X\n SG_ Phi : 0|16@1+ (0.01,0) [0|0] \"deg\" X\n";
  ifog::DriverInstance d = driver(text, {{"signal", "Phi"}, {"kind", "angle"}});
  EXPECT_DOUBLE_EQ(d.description().angle_wrap_rad, 655.36 * std::numbers::pi / 180.0);
  ifog::DriverInstance e = driver(text, {{"signal", "Phi"}, {"kind", "angle"}, {"wrap", "360"}});
  EXPECT_DOUBLE_EQ(e.description().angle_wrap_rad, 2.0 * std::numbers::pi);
  ifog::DriverInstance f = driver(text, {{"signal", "Phi"}, {"kind", "angle"}, {"wrap", "none"}});
  EXPECT_EQ(f.description().angle_wrap_rad, 0.0);
}

// Ranges of real files are often wrong, as [0|127.5] of a signed speed: they are information. Each value is
// kept; those beyond are counted, their samples flagged, and the first is reported with both numbers.
TEST_F(DbcText, AValueBeyondTheStatedRangeIsKeptCountedAndFlagged) {
  const std::string text =
      "BO_ 1 A: 8 X\n SG_ R : 0|16@1- (0.01,0) [0|50] \"deg/s\" X\n SG_ T : 16|8@1- (1,0) [-40|85] "
      "\"degC\" X\n";
  ifog::DriverInstance d =
      driver(text, {{"signal", "R"}, {"environment", "temperature_degC=T"}, {"rate_hz", "100"}});
  struct Case {
    int hundredths, temperature;
    std::uint64_t beyond;
  };
  std::uint64_t before = 0;
  for (const Case& c : {Case{5000, 85, 0}, Case{0, -40, 0}, Case{-9999, 20, 1}, Case{5001, 86, 3}}) {
    const std::vector<ifog_sample> s = decode(
        d,
        {frame(1, {c.hundredths & 0xFF, (c.hundredths >> 8) & 0xFF, c.temperature & 0xFF, 0, 0, 0, 0, 0})});
    ASSERT_EQ(s.size(), 1U);
    EXPECT_EQ(s[0].valid_axes, 1U) << c.hundredths;
    EXPECT_NEAR(s[0].value[0], c.hundredths * 0.01 * std::numbers::pi / 180.0, 1e-12);
    EXPECT_EQ(s[0].environment[0], c.temperature);
    EXPECT_EQ((s[0].flags & IFOG_SAMPLE_BEYOND) != 0, c.beyond != before) << c.hundredths;
    before = c.beyond;
    EXPECT_EQ(d.counters().values_beyond, c.beyond);
  }
  EXPECT_EQ(std::string(d.counters().beyond_name), "R");
  EXPECT_DOUBLE_EQ(d.counters().beyond_value, -99.99);
  EXPECT_EQ(d.counters().beyond_minimum, 0.0);
  EXPECT_EQ(d.counters().beyond_maximum, 50.0);
  EXPECT_EQ(d.description().full_scale[0], 0.0);
  const ifog::DriverInstance unlike = driver(text, {{"signal", "R"}, {"environment", "supply_V=T"}});
  ASSERT_EQ(unlike.warnings().size(), 1U);
  EXPECT_EQ(
      unlike.warnings()[0],
      "driver dbc: environment: 'supply_V': its unit is stated as 'degC', which is not converted to 'V': "
      "values are used as they are");
}

// Axes in one message, distinguished by a multiplexor; CAN FD; what is encoded decodes to the same sample.
TEST_F(DbcText, MultiplexedAxesAndLongFramesRoundTrip) {
  const std::string text =
      "BO_ 2147483904 M: 8 X\n SG_ S M : 0|8@1+ (1,0) [0|0] \"\" X\n SG_ N : 8|8@1+ (1,0) [0|0] \"\" X\n"
      " SG_ X m1 : 16|32@1- (1,0) [0|0] \"rad/s\" X\n SG_ Y m2 : 16|32@1- (1,0) [0|0] \"rad/s\" X\n"
      " SG_ Z m5 : 23|32@0- (1,0) [0|0] \"rad/s\" X\n"
      "BO_ 300 L: 20 X\n SG_ T : 128|32@1- (1,0) [0|0] \"degF\" X\n"
      "SIG_VALTYPE_ 2147483904 X : 1;\nSIG_VALTYPE_ 2147483904 Y : 1;\nSIG_VALTYPE_ 2147483904 Z : "
      "1;\nSIG_VALTYPE_ 300 T : 1;\n";
  ifog::DriverInstance d = driver(
      text,
      {{"x", "X"}, {"y", "Y"}, {"z", "Z"}, {"counter", "M.N"}, {"environment", "temperature_degC=L.T"}});
  ifog_sample sample{};
  sample.flags = IFOG_SAMPLE_SEQUENCE;
  sample.sequence = 9;
  sample.value[0] = 0.25;
  sample.value[1] = -0.5;
  sample.value[2] = 4.0;
  sample.environment[0] = 21.5;
  sample.environment_fresh = 1;
  std::vector<ifog_can_frame> frames;
  d.encode_can(sample, frames);
  ASSERT_EQ(frames.size(), 4U);
  EXPECT_EQ(frames[0].id, 300U);
  EXPECT_EQ(frames[0].flags, IFOG_CAN_FD);
  EXPECT_EQ(frames[0].length, 20U);
  float sent = 0.0F;
  std::memcpy(&sent, frames[0].data + 16, sizeof sent);
  EXPECT_FLOAT_EQ(sent, 70.7F);  // degF, as the file states
  EXPECT_EQ(frames[1].id, 256U);
  EXPECT_EQ(frames[1].flags, IFOG_CAN_EXTENDED);
  EXPECT_EQ(frames[1].data[0], 1U);
  EXPECT_EQ(frames[1].data[1], 9U);
  EXPECT_EQ(frames[3].data[0], 5U);
  EXPECT_EQ(frames[3].data[2], 0x40U);  // 4.0 is 0x40800000, the sign first
  const std::vector<ifog_sample> back = decode(d, frames);
  ASSERT_EQ(back.size(), 1U);
  for (int i = 0; i < 3; ++i) EXPECT_EQ(back[0].value[i], sample.value[i]);
  EXPECT_NEAR(back[0].environment[0], 21.5, 1e-5);
  EXPECT_EQ(back[0].sequence, 9U);
}

}  // namespace
