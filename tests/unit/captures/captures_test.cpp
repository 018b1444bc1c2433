// SPDX-License-Identifier: Apache-2.0
// Recordings of messages and of several runs, models of other axes, and axes of several captures.
#include "drivers/capture/files/input_file.h"
#include "tests/unit/capture/read_capture.h"
#include "tests/unit/flight/recordings.h"
#include "tests/unit/messages.h"
#include "tests/unit/test.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/capture_output.h"
#include "tools/ifog/captures/flight/flight_input.h"
#include "tools/ifog/captures/lcm/message_archive.h"
#include "tools/ifog/captures/long_capture.h"
#include "tools/ifog/captures/usable_axes.h"

// Messages into recordings: what is lost is lost in one place, and a folder is one recorder's.

namespace ifog::tools {
namespace {

FlightHeader of_messages() {
  FlightHeader out = some_header();
  out.carries = FlightHeader::Carries::messages;
  return out;
}

std::vector<std::uint8_t> message_of(std::int64_t seq) {
  rate_t message = rate(1);
  message.seq = seq;
  message.utime = kWall / 1000 + seq * 1000;
  message.sensor_time_ns = -1;
  message.dt = 1e-3;
  return encoded(message);
}

// A disk that takes nothing for a while, and messages that LCM lost before and after, while the disk was
// well.
TEST(MessageArchive, WhatIsLostHereIsNotLostOnTheWayAsWell) {
  MemoryDisk disk;
  MessageArchive archive(std::make_unique<MemoryFolder>(disk), {}, of_messages());
  std::int64_t now_ns = 0;
  archive.open(now_ns, kWall);
  std::uint64_t heard = 0;
  for (std::int64_t seq = 0; seq < 20'000; ++seq) {
    disk.refuses = seq >= 5000 && seq < 12'000 ? ENOSPC : 0;
    now_ns += kSecond / 1000;
    if ((seq >= 1000 && seq < 1100) || (seq >= 15'000 && seq < 15'007)) continue;
    archive.take("IFOG_NOSE", message_of(seq), (kWall + now_ns) / 1000, now_ns, kWall + now_ns);
    archive.turn(now_ns, kWall + now_ns);
    ++heard;
  }
  archive.close(now_ns, kWall + now_ns);
  const MessageArchive::Books books = archive.books();
  EXPECT_EQ(books.received, heard);
  EXPECT_EQ(books.lost_on_way, 107U);
  EXPECT_GT(books.lost_here, 1000U);
  // What the recording holds and what it says is lost is all there was.
  const std::vector<std::uint8_t> all = all_of(disk);
  FlightReader reader(all);
  std::uint64_t held = 0;
  for (auto item = reader.next(); item != FlightReader::Item::end; item = reader.next())
    if (item == FlightReader::Item::entry && reader.entry().head.kind == FlightKind::message) ++held;
  EXPECT_EQ(held, heard - books.lost_here);
  EXPECT_EQ(reader.counts().lost_messages, books.lost_here + books.lost_on_way);
  EXPECT_EQ(held + reader.counts().lost_messages, 20'000U);
}

// A recording of several runs of the daemon, each with its own options of the driver.

constexpr int kSamples = 40;

double rate_of(int n) { return 1e-3 * (n + 1); }

// One run, of frames as a device sends them that is set up so, in files of so many bytes.
std::string run_of(const DriverSettings& options, std::uint64_t run, std::int64_t from_ns,
                   std::uint64_t file_bytes = 1'000'000) {
  DriverInstance driver = make_driver("kvh1750", options);
  MemoryDisk disk;
  FlightHeader header = some_header();
  header.channels = {};
  header.options = options;
  header.run = run;
  ArchiveLimits limits;
  limits.file_bytes = file_bytes;
  FlightArchive archive(std::make_unique<MemoryFolder>(disk), limits, header);
  for (int n = 0; n < kSamples; ++n) {
    ifog_sample sample{};
    sample.flags = IFOG_SAMPLE_SEQUENCE;
    sample.sequence = static_cast<std::uint32_t>(n);
    sample.valid_axes = 7;
    for (double& value : sample.value) value = rate_of(n);
    for (double& value : sample.environment) value = 20.0;
    sample.environment_fresh = ~0U;
    std::vector<std::uint8_t> frame;
    driver.encode_bytes(sample, frame);
    // Not as evenly as it is sent.
    const std::int64_t read_ns = from_ns + 10'000'000 * n + 1'000'000 * (n % 3);
    archive.add({FlightKind::bytes, 0, 0, 0, read_ns}, frame);
    archive.turn(read_ns, 0, true);
  }
  archive.close(from_ns + 1'000'000'000, 0);
  EXPECT_EQ(disk.files.size() > 2, file_bytes < 2000);
  const std::vector<std::uint8_t> bytes = all_of(disk);
  return {bytes.begin(), bytes.end()};
}

const DriverSettings kRadians{{"format", "a"}, {"rate_hz", "100"}};
const DriverSettings kDegrees{{"format", "a"}, {"rate_hz", "100"}, {"angle_unit", "degrees"}};

std::string both_runs() { return run_of(kRadians, 7, 1'000'000'000) + run_of(kDegrees, 8, 9'000'000'000); }

LongCapture read(InputFile& file, const CaptureInput& input = {}) {
  return {input.read_long(file), file.path()};
}

// Each with its own options: tests/system/field/runs.py.
TEST(FlightRuns, AnOptionOfTheCommandLineStandsOverEach) {
  std::string text = run_of(kDegrees, 7, 1'000'000'000) + run_of(kDegrees, 8, 9'000'000'000);
  InputFile file("both.ifr", std::move(text));
  CaptureInput input;
  input.options = {"angle_unit=radians"};
  const LongCapture whole = read(file, input);
  const CaptureView& capture = whole.view();
  EXPECT_NEAR(capture.rate_radps[0].back() / rate_of(kSamples - 1), 57.29578, 1e-3);
}

TEST(FlightRuns, WhatEveryDriverCountedIsCounted) {
  InputFile file("both.ifr", both_runs());
  FlightInput flight(file);
  DriverInstance driver = flight.make_driver("", {});
  const RecordingCounts counts = flight.for_each_sample(driver, {[](const RecordedSample&) {}, [] {}});
  EXPECT_EQ(counts.samples, 2U * kSamples);
  EXPECT_EQ(counts.driver.frames_good, 2U * kSamples);
  EXPECT_EQ(counts.driver.bytes_framed, 2U * kSamples * 36U);
}

// Files of one run continue without a break, in the middle of a frame, too.
TEST(FlightRuns, FilesOfOneRunAreOneRecord) {
  // By the counter, however late the first frame of a file came.
  InputFile file("files.ifr", run_of(kRadians, 7, 1'000'000'000, 1000));
  const LongCapture whole = read(file);
  const CaptureView& capture = whole.view();
  ASSERT_EQ(capture.size(), std::size_t{kSamples});
  for (std::size_t i = 1; i < capture.size(); ++i)
    EXPECT_NEAR(capture.time_s[i] - capture.time_s[i - 1], 0.01, 1e-9) << i;
}

TEST(FlightRuns, OtherColumnsAreRefused) {
  ifog_description one = make_driver("kvh1750", kRadians).description();
  test::Built builder(one);
  EXPECT_NO_THROW(builder.go_on_as(one));
  one.axes = 2;
  EXPECT_THROW(builder.go_on_as(one), std::runtime_error);
}

// A model of three axes on a capture that has two of them.

Effect effect(const std::string& axis, const std::string& channel, std::size_t parameters) {
  Effect out;
  out.form = "linear";
  out.axis = axis;
  out.channel = channel;
  for (std::size_t i = 0; i < parameters; ++i)
    out.parameters.push_back({i == 0 ? "coefficient" : "other", 1.0, 0.1, ""});
  return out;
}

// Each number of the covariance says where it stood.
Model three() {
  Model model;
  model.effects = {effect("x", "temperature_degC", 1), effect("y", "temperature_degC", 2),
                   effect("z", "rate_y_radps", 1), effect("z", "supply_V", 2)};
  for (int row = 0; row < 6; ++row)
    for (int column = 0; column < 6; ++column) model.covariance.push_back(10.0 * row + column);
  return model;
}

TEST(ModelAxes, EffectsOfAnAxisAndOnItsRateGoWithTheirCovariance) {
  const Model left = without_axes(three(), {"y"});
  ASSERT_EQ(left.effects.size(), 2U);
  EXPECT_EQ(left.effects[0].axis, "x");
  EXPECT_EQ(left.effects[1].channel, "supply_V");
  EXPECT_EQ(left.covariance, (std::vector<double>{0, 4, 5, 40, 44, 45, 50, 54, 55}));
}

TEST(ModelAxes, WithoutAnythingToLeaveOutItStaysAsItIs) {
  EXPECT_EQ(without_axes(three(), {}).identity(), three().identity());
  EXPECT_EQ(without_axes(three(), {"w"}).identity(), three().identity());
  EXPECT_EQ(without_axes(three(), {""}).identity(), three().identity());
}

// Which axes a fit can use.

Capture capture_of(std::size_t rows, const std::vector<std::string>& axes) {
  Capture out;
  for (std::size_t i = 0; i < rows; ++i) out.time_s.push_back(0.01 * static_cast<double>(i));
  for (std::size_t a = 0; a < axes.size(); ++a) {
    out.axes.push_back(axes[a]);
    out.reference_rate_radps.emplace_back();
    std::vector<double>& rate = out.rate_radps.emplace_back();
    for (std::size_t i = 0; i < rows; ++i) rate.push_back(std::sin(static_cast<double>(7 * i + a)));
  }
  return out;
}

// A coarse sensor at rest repeats itself: a few equal rows say nothing.
TEST(UsableAxes, AFewEqualRowsAreNoStuckAxis) {
  Capture capture = capture_of(100, {"x", "y"});
  capture.rate_radps[1].assign(100, 0.0);
  EXPECT_TRUE(unusable_axes({capture}, {"a.csv"}).empty());
}

TEST(UsableAxes, OneOfSeveralCapturesLeavesItOutOfAll) {
  Capture one = capture_of(300, {"x", "y"}), other = one;
  one.rate_radps[1].assign(300, 0.0);
  std::vector<CaptureView> both{one, other};
  const std::vector<std::string> out = unusable_axes(both, {"a.csv", "b.csv"});
  for (CaptureView& each : both) {
    leave_out(out, each);
    EXPECT_EQ(each.axes, (std::vector<std::string>{"x"}));
    EXPECT_EQ(each.dead_axes, (std::vector<std::string>{"y"}));
  }
  other.rate_radps[0].assign(300, 0.0);
  both = {one, other};
  EXPECT_THROW((void)unusable_axes(both, {"a.csv", "b.csv"}), std::runtime_error);
}

}  // namespace
}  // namespace ifog::tools
