// SPDX-License-Identifier: Apache-2.0
// Captures to what a device would have sent, and back, through the real plugins.
#include <unistd.h>
#include <zlib.h>

#include "drivers/capture/candump/candump.h"
#include "drivers/capture/capture_encoder.h"
#include "drivers/capture/recording.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/test.h"

namespace {

namespace fs = std::filesystem;
using ifog::Capture;
using ifog::DriverSettings;

constexpr double kNaN = std::numeric_limits<double>::quiet_NaN();
const std::string kBus = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/ifogd_gyro.dbc";

// 1000 samples at 200 Hz, with `missing` rows dropped after row 500.
Capture wave(const std::vector<std::string>& axes, int missing = 0) {
  Capture c;
  c.axes = axes;
  c.rate_radps.resize(axes.size());
  c.reference_rate_radps.resize(axes.size());
  c.channels = {{"temperature_degC", {}}, {"extra_V", {}}};
  for (int i = 0; i < 1000; ++i) {
    const int k = i < 500 ? i : i + missing;
    c.time_s.push_back(k / 200.0);
    for (std::size_t a = 0; a < axes.size(); ++a)
      c.rate_radps[a].push_back(2.0 * std::sin(0.01 * k + static_cast<double>(a)));
    c.channels[0].values.push_back(i % 10 == 0 ? 20.0 + i / 100 : kNaN);
    c.channels[1].values.push_back(i);
  }
  return c;
}

class Recording : public testing::Test, protected ifog::test::OwnFolder {
 protected:
  // Encodes with one instance of the driver and decodes with another.
  Capture there_and_back(const Capture& capture, const std::string& driver, const DriverSettings& settings) {
    const auto plugin = ifog::find_plugin(driver, ifog::plugin_folders());
    const DriverSettings all = ifog::with_rate(capture, *plugin, settings);
    ifog::DriverInstance out(plugin, all);
    ifog::CaptureEncoder encoder(capture, out);
    std::string file;
    if (out.takes_can()) {
      file = path("frames.log");
      std::ofstream log(file);
      std::vector<ifog_can_frame> frames;
      while (encoder.next(frames)) {
      }
      char line[ifog::kCandumpLineMax];
      for (const ifog_can_frame& frame : frames)
        log.write(line, static_cast<std::streamsize>(ifog::format_candump_line(frame, "vcan0", line)));
    } else {
      file = path("bytes.bin");
      std::vector<std::uint8_t> bytes;
      while (encoder.next(bytes)) {
      }
      std::ofstream(file, std::ios::binary)
          .write(reinterpret_cast<const char*>(bytes.data()), static_cast<std::streamsize>(bytes.size()));
    }
    notices_ = encoder.notices();
    ifog::DriverInstance in(plugin, all);
    ifog::test::Built builder(in.description());
    ifog::InputFile recorded(file);
    counts_ =
        ifog::decode_recording(recorded, in, "", [&](const ifog_sample& sample) { builder.add(sample); });
    missing_ = builder.counts().missing;
    return builder.finish();
  }

  // Rates equal to the precision a float keeps (or `tolerance`), times exactly.
  static void expect_same(const Capture& a, const Capture& b, double tolerance = 0.0) {
    ASSERT_EQ(a.time_s, b.time_s);
    ASSERT_EQ(a.rate_radps.size(), b.rate_radps.size());
    for (std::size_t axis = 0; axis < a.rate_radps.size(); ++axis)
      for (std::size_t i = 0; i < a.size(); ++i) {
        const double expected = a.rate_radps[axis][i];
        const double allowed = tolerance > 0.0 ? tolerance : std::abs(expected) * 6e-8;
        ASSERT_NEAR(b.rate_radps[axis][i], expected, allowed) << "axis " << axis << " row " << i;
      }
  }

  ifog::RecordingCounts counts_;
  std::vector<std::string> notices_;
  std::size_t missing_ = 0;
};

TEST_F(Recording, KvhFormatsKeepRatesTimesAndGaps) {
  for (const char* format : {"a", "b", "c"}) {
    const Capture capture = wave({"x", "y", "z"}, 40);
    const Capture back = there_and_back(capture, "kvh1750", {{"format", format}});
    expect_same(capture, back);
    EXPECT_EQ(back.axes, capture.axes);
    EXPECT_EQ(counts_.samples, 1000U);
    EXPECT_EQ(counts_.driver.bytes_skipped, 0U);
    EXPECT_EQ(missing_, 40U) << format;
  }
  ASSERT_EQ(notices_.size(), 2U);
  EXPECT_EQ(notices_[0], "not sent, as the format as set up has no place for it: extra_V");
}

TEST_F(Recording, AnglesAndIncrementsBecomeTheSameRates) {
  const Capture capture = wave({""}, 3);
  // A delta angle is rad: a float of 0.01 rad resolves 1e-9 rad, 2e-7 rad/s at 200 Hz.
  Capture back =
      there_and_back(wave({"x", "y", "z"}), "kvh1750", {{"output", "delta"}, {"angle_unit", "degrees"}});
  expect_same(wave({"x", "y", "z"}), back, 4e-7);
  const std::string dbc = std::string(IFOG_SOURCE_DIR) + "/drivers/dbc/examples/goetting_hg_g_84300.dbc";
  back = there_and_back(capture, "dbc",
                        {{"dbc", dbc},
                         {"signal", "Angle"},
                         {"kind", "angle"},
                         {"counter", "Cycle"},
                         {"environment", "temperature_degC=Temperature"}});
  // A float32 angle near π resolves 2.4e-7 rad, so its difference over 5 ms no better than 5e-5 rad/s.
  EXPECT_TRUE(std::isnan(back.rate_radps[0][0]));
  back.rate_radps[0][0] = capture.rate_radps[0][0];
  expect_same(capture, back, 1e-4);
}

TEST_F(Recording, DbcKeepsThreeAxesAndSlowChannels) {
  const Capture capture =
      wave({"x", "y", "z"}, 70000);  // more than the 16-bit counter: seen in the arrival times
  const Capture back = there_and_back(capture, "dbc",
                                      {{"dbc", kBus},
                                       {"x", "Rate_x"},
                                       {"y", "Rate_y"},
                                       {"z", "Rate_z"},
                                       {"counter", "Counter"},
                                       {"environment", "temperature_degC=Temperature"}});
  expect_same(capture, back);
  EXPECT_EQ(missing_, 70000U);
  ASSERT_EQ(back.channels.size(), 1U);
  for (std::size_t i = 0; i < back.size(); ++i)
    if (i % 10 == 0)
      EXPECT_EQ(back.channels[0].values[i], capture.channels[0].values[i]);
    else
      EXPECT_TRUE(std::isnan(back.channels[0].values[i]));
}

TEST_F(Recording, OneIdOnTwoInterfacesIsTwoDevices) {
  const DriverSettings settings{{"dbc", kBus}, {"signal", "Rate_x"}, {"counter", "Counter"}};
  there_and_back(wave({""}), "dbc", settings);
  std::ifstream one(path("frames.log"));
  std::ofstream two(path("two.log"));
  for (std::string line; std::getline(one, line);) {
    two << line << "\n";
    two << line.replace(line.find("vcan0"), 5, "vcan1") << "\n";
  }
  two << "(5.0) can9 7FF#00\n(5.0) can8 7FF#00\n";  // not the driver's
  two.close();
  const auto samples = [&](const std::string& interface) {
    ifog::DriverInstance driver = ifog::make_driver("dbc", settings);
    ifog::InputFile file(path("two.log"));
    return ifog::decode_recording(file, driver, interface, [](const ifog_sample&) {}).samples;
  };
  EXPECT_EQ(samples("vcan0"), 1000U);
  EXPECT_EQ(samples("vcan1"), 1000U);
  EXPECT_EQ(ifog::test::refusal([&] { samples(""); }, "taken for one"),
            path("two.log") +
                ": frames of one id come on 'vcan0' and on 'vcan1', as from two devices, "
                "expected --channel with one of them");
}

// A clock that counts in µs from 0 would show the last of its round.
TEST_F(Recording, TimesBeforeZeroGoByWholeSecondsLaterAndSaySo) {
  Capture early = wave({"x", "y", "z"});
  for (double& time : early.time_s) time -= 1.25;
  for (const char* driver : {"kvh1750", "sbgecom"}) {
    const Capture back =
        there_and_back(early, driver, driver[0] == 'k' ? DriverSettings{{"format", "b"}} : DriverSettings{});
    EXPECT_NE(std::ranges::find(
                  notices_,
                  "begins at -1.25 s, and no clock of a device shows times before 0: all are sent 2 s later"),
              notices_.end());
    ASSERT_EQ(back.size(), early.size());
    for (std::size_t i = 0; i < back.size(); ++i) ASSERT_NEAR(back.time_s[i], early.time_s[i] + 2.0, 1.01e-6);
  }
  Capture one = wave({""});
  for (double& time : one.time_s) time -= 1.25;
  const Capture back =
      there_and_back(one, "dbc", {{"dbc", kBus}, {"signal", "Rate_x"}, {"counter", "Counter"}});
  ASSERT_EQ(back.size(), one.size());
  for (std::size_t i = 0; i < back.size(); ++i)
    ASSERT_NEAR(back.time_s[i], static_cast<double>(i) / 200.0, 1.01e-6);
  // Format A has no time to show.
  there_and_back(early, "kvh1750", {{"format", "a"}});
  EXPECT_EQ(notices_.size(), 2U);
}

TEST_F(Recording, ACutOffFileIsCounted) {
  const Capture capture = wave({"x", "y", "z"});
  there_and_back(capture, "kvh1750", {{"format", "a"}});
  fs::resize_file(path("bytes.bin"), 36 * 500 + 20);
  ifog::DriverInstance driver = ifog::make_driver("kvh1750", {});
  ifog::InputFile bytes(path("bytes.bin"));
  const ifog::RecordingCounts counts = ifog::decode_recording(bytes, driver, "", [](const ifog_sample&) {});
  EXPECT_EQ(counts.samples, 500U);
  EXPECT_EQ(counts.bytes_at_end, 20U);
}

TEST_F(Recording, ARateOutOfTheFormatsRangeIsRefusedWithItsTime) {
  Capture capture = wave({""});
  capture.rate_radps[0][4] = 1e6;
  const auto plugin = ifog::find_plugin("template", ifog::plugin_folders());
  ifog::DriverInstance driver(plugin, {});
  ifog::CaptureEncoder encoder(capture, driver);
  std::vector<std::uint8_t> bytes;
  const auto encode = [&] {
    while (encoder.next(bytes)) {
    }
  };
  EXPECT_EQ(ifog::test::refusal(encode),
            "at 0.02 s: driver template: rate is 1000000.000000 rad/s, expected within ±37");
  EXPECT_EQ(bytes.size(), 4U * 8U);
  const Capture three = wave({"x", "y", "z"});
  EXPECT_EQ(ifog::test::refusal([&] { ifog::CaptureEncoder(three, driver, "q"); }),
            "--axis is 'q', expected none for a capture of several axes");
}

// As of a capture's own cells: no temperature is below absolute zero.
TEST_F(Recording, AChannelsValueThatCannotBeIsMissingAndCounted) {
  ifog_description d{};
  d.axes = 1;
  d.nominal_rate_hz = 100.0;
  d.environments = 1;
  std::string("temperature_degC").copy(d.environment[0], sizeof d.environment[0] - 1);
  ifog::test::Built builder(d, {"coil_degC"});
  ifog_sample sample{};
  sample.valid_axes = 1;
  sample.environment_fresh = 1;
  for (const double value : {20.0, -1000.0, -270.0}) {
    sample.environment[0] = value;
    builder.add(sample, std::vector{value - 5.0});
  }
  EXPECT_EQ(builder.remarks(),
            std::vector<std::string>{"3 values of channels cannot be, in the unit of their name: dropped"});
  const Capture made = builder.finish();
  EXPECT_EQ(made.channels.at(0).values[0], 20.0);
  EXPECT_TRUE(std::isnan(made.channels.at(0).values[1]));
  EXPECT_EQ(made.channels.at(0).values[2], -270.0);
  EXPECT_EQ(made.channels.at(1).values[0], 15.0);
  EXPECT_TRUE(std::isnan(made.channels.at(1).values[1]) && std::isnan(made.channels.at(1).values[2]));
}

TEST_F(Recording, APackedOneThatEndsEarlyIsReadAsFarAsItGoes) {
  (void)there_and_back(wave({"x", "y", "z"}), "kvh1750", {{"format", "b"}});
  std::ifstream plain(path("bytes.bin"), std::ios::binary);
  const std::string bytes((std::istreambuf_iterator<char>(plain)), {});
  const std::string name = path("bytes.bin.gz");
  gzFile packed = gzopen(name.c_str(), "wb");
  ASSERT_EQ(gzwrite(packed, bytes.data(), static_cast<unsigned>(bytes.size())),
            static_cast<int>(bytes.size()));
  gzclose(packed);
  fs::resize_file(name, fs::file_size(name) / 2);
  ifog::DriverInstance driver(ifog::find_plugin("kvh1750", ifog::plugin_folders()), {{"format", "b"}});
  ifog::InputFile file(name);
  std::size_t samples = 0;
  const ifog::RecordingCounts counts =
      ifog::decode_recording(file, driver, "", [&](const ifog_sample&) { ++samples; });
  EXPECT_GT(samples, 100U);
  EXPECT_LT(samples, 900U);
  const std::vector<std::string> said = ifog::losses(counts);
  EXPECT_EQ(std::ranges::count(said, "1 gzip stream ends early (truncated file); what is there was read"), 1);
}

}  // namespace
