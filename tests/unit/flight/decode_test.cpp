// SPDX-License-Identifier: Apache-2.0
// A recording through its driver: the samples that the driver gave when it was recorded.
#include "drivers/flight/decode.h"

#include <gtest/gtest.h>

#include "tests/unit/flight/recordings.h"

namespace ifog {
namespace {

struct Seen {
  std::uint32_t sequence;
  std::int64_t arrival_ns, read_ns;
  double rate, outside;
  float age_s;
  std::int64_t wall_shift_ns;
  bool operator==(const Seen&) const = default;
};

struct Stream {
  std::vector<std::vector<std::uint8_t>> frames;
  explicit Stream(int count) {
    DriverInstance driver = make_driver("kvh1750", {{"format", "a"}});
    for (int n = 0; n < count; ++n) {
      ifog_sample sample{};
      sample.flags = IFOG_SAMPLE_SEQUENCE;
      sample.sequence = static_cast<std::uint32_t>(n % 128);
      sample.valid_axes = 7;
      for (double& value : sample.value) value = 1e-3 * n;
      for (double& value : sample.environment) value = 20.0;
      sample.environment_fresh = ~0U;
      driver.encode_bytes(sample, frames.emplace_back());
    }
  }
};

std::vector<Seen> decoded(const std::vector<std::uint8_t>& recording, int& breaks) {
  FlightReader reader(recording);
  EXPECT_EQ(reader.next(), FlightReader::Item::header);
  DriverInstance driver = make_driver(reader.header().driver, reader.header().options);
  std::vector<Seen> out;
  breaks = 0;
  decode_flight(reader, driver,
                {[&](const RecordedSample& recorded) {
                   const ChannelValue& outside = recorded.outside[1];
                   out.push_back({recorded.sample.sequence, recorded.sample.arrival_ns, recorded.read_ns,
                                  recorded.sample.value[0], outside.value, outside.age_s(recorded.read_ns),
                                  recorded.wall_shift_ns});
                 },
                 [&] { ++breaks; }});
  return out;
}

FlightHeader header() {
  FlightHeader out = some_header();
  out.options = {{"format", "a"}};
  return out;
}

TEST(FlightDecode, SamplesTimesAndChannelsAreThoseOfTheRecording) {
  const Stream stream(40);
  MemoryDisk disk;
  ArchiveLimits limits;
  limits.file_bytes = 1500;
  std::vector<Seen> expected;
  FlightArchive archive(std::make_unique<MemoryFolder>(disk), limits, header());
  double outside = std::numeric_limits<double>::quiet_NaN();
  std::int64_t outside_ns = 0, shift_ns = 0;
  std::vector<std::uint8_t> held;
  for (int n = 0; n < 40; ++n) {
    const std::int64_t now_ns = 1'000'000 * (n + 1);
    if (n % 10 == 5) {
      outside = n;
      outside_ns = now_ns - 100;
      archive.add({FlightKind::channel, 0, 1, 0, outside_ns}, {reinterpret_cast<std::uint8_t*>(&outside), 8});
    }
    if (n == 20) {
      shift_ns = -77;
      archive.add({FlightKind::wall, 0, 0, 0, 0}, {reinterpret_cast<std::uint8_t*>(&shift_ns), 8});
    }
    // In pieces that are no frames, so that frames go over the ends of files.
    const auto& frame = stream.frames[static_cast<std::size_t>(n)];
    const std::uint8_t flags = n % 3 == 0 ? kFlightReadTime : 0;
    held.insert(held.end(), frame.begin(), frame.begin() + 20);
    archive.add({FlightKind::bytes, flags, 0, 0, now_ns}, held);
    held.assign(frame.begin() + 20, frame.end());
    archive.turn(now_ns, 0, true);
    if (n > 0)
      expected.push_back({static_cast<std::uint32_t>(n - 1), flags != 0 ? 0 : now_ns, now_ns,
                          static_cast<double>(static_cast<float>(1e-3 * (n - 1))), outside,
                          ChannelValue{outside, outside_ns}.age_s(now_ns), shift_ns});
  }
  archive.close(1'000'000'000, 0);
  ASSERT_GT(disk.files.size(), 2U);
  int breaks = 0;
  std::vector<Seen> seen = decoded(all_of(disk), breaks);
  EXPECT_EQ(breaks, 0);
  ASSERT_EQ(seen.size(), expected.size());
  for (std::size_t i = 0; i < seen.size(); ++i) {
    if (std::isnan(seen[i].outside) && std::isnan(expected[i].outside))
      seen[i].outside = expected[i].outside = 0.0;
    EXPECT_EQ(seen[i], expected[i]) << i;
  }
}

// Half a frame before a hole and half of another behind it make no frame.
TEST(FlightDecode, NothingIsPutTogetherOverAHole) {
  const Stream stream(4);
  MemoryDisk disk;
  FlightArchive archive(std::make_unique<MemoryFolder>(disk), {}, header());
  const auto add = [&](std::span<const std::uint8_t> bytes, std::uint8_t flags = 0) {
    archive.add({FlightKind::bytes, flags, 0, 0, 1}, bytes);
  };
  add(stream.frames[0]);
  add(std::span(stream.frames[1]).first(20));
  const std::uint64_t lost[2] = {3, 36};
  archive.add({FlightKind::lost, 0, 0, 0, 2}, {reinterpret_cast<const std::uint8_t*>(lost), sizeof lost});
  add(std::span(stream.frames[1]).subspan(20));
  add(stream.frames[2]);
  add(std::span(stream.frames[3]).first(20));
  add(std::span(stream.frames[3]).subspan(20), kFlightReopened);
  archive.close(3, 0);
  const std::vector<std::uint8_t> recording = all_of(disk);
  int breaks = 0;
  const std::vector<Seen> seen = decoded(recording, breaks);
  ASSERT_EQ(seen.size(), 2U);
  EXPECT_EQ(seen[0].sequence, 0U);
  EXPECT_EQ(seen[1].sequence, 2U);
  EXPECT_EQ(breaks, 2);
  const FlightCounts counts = read_back(recording).counts;
  EXPECT_EQ(counts.lost_deliveries, 3U);
  EXPECT_EQ(counts.lost_bytes, 36U);
}

TEST(FlightDecode, AnotherSensorBehindTheFirstIsRefused) {
  const Stream stream(1);
  std::vector<std::uint8_t> both;
  for (const char* const sensor : {"nose", "tail"}) {
    MemoryDisk disk;
    FlightHeader one = header();
    one.sensor = sensor;
    FlightArchive archive(std::make_unique<MemoryFolder>(disk), {}, one);
    archive.add({FlightKind::bytes, 0, 0, 0, 1}, stream.frames[0]);
    archive.close(1, 0);
    const std::vector<std::uint8_t> bytes = all_of(disk);
    both.insert(both.end(), bytes.begin(), bytes.end());
  }
  int breaks = 0;
  EXPECT_THROW(decoded(both, breaks), std::runtime_error);
}

TEST(FlightDecode, CanFramesComeBackToTheBit) {
  std::vector<std::uint8_t> payload{0x45, 0x23, 0x01, 0x10, IFOG_CAN_EXTENDED, 3, 7, 8, 9};
  FlightEntry entry{{FlightKind::can, 0, 0, 9, 55}, payload};
  ifog_can_frame frame{};
  ASSERT_TRUE(frame_of(entry, frame));
  EXPECT_EQ(frame.id, 0x10012345U);
  EXPECT_EQ(frame.flags, IFOG_CAN_EXTENDED);
  EXPECT_EQ(frame.length, 3);
  EXPECT_EQ(frame.data[2], 9);
  EXPECT_EQ(frame.arrival_ns, 55);
  entry.head.flags = kFlightReadTime;
  ASSERT_TRUE(frame_of(entry, frame));
  EXPECT_EQ(frame.arrival_ns, 0);
  payload[5] = 4;  // more than there is
  EXPECT_FALSE(frame_of(entry, frame));
  payload[5] = 65;
  payload.resize(6 + 65);
  entry.payload = payload;
  EXPECT_FALSE(frame_of(entry, frame));
}

}  // namespace
}  // namespace ifog
