// SPDX-License-Identifier: Apache-2.0
// A recording of several runs of the daemon, each with its own options of the driver.
#include <gtest/gtest.h>

#include <stdexcept>

#include "tests/unit/capture/read_capture.h"
#include "tests/unit/flight/recordings.h"
#include "tools/ifog/captures/capture_input.h"
#include "tools/ifog/captures/flight/flight_input.h"

namespace ifog::tools {
namespace {

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

void expect_the_rates(const CaptureView& capture) {
  ASSERT_EQ(capture.size(), 2U * kSamples);
  for (int n = 0; n < kSamples; ++n)
    for (const int row : {n, n + kSamples})
      EXPECT_NEAR(capture.rate_radps[0][static_cast<std::size_t>(row)], rate_of(n), 1e-8) << row;
}

// What the device sent in degrees, read in radians, would be rates 57 times as large.
TEST(FlightRuns, EachIsReadWithItsOwnOptions) {
  InputFile file("both.ifr", both_runs());
  const LongCapture whole = read(file);
  const CaptureView& capture = whole.view();
  expect_the_rates(capture);
  EXPECT_NEAR(capture.time_s[kSamples] - capture.time_s[kSamples - 1], 8.0 - 0.01 * (kSamples - 1), 0.003);
}

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

}  // namespace
}  // namespace ifog::tools
