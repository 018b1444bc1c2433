// SPDX-License-Identifier: Apache-2.0
// A recording through its driver: the samples that the driver gave when it was recorded.
#include "drivers/flight/decode.h"
#include "tests/unit/daemon/kvh_frames.h"
#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

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
    for (int n = 0; n < count; ++n)
      frames.push_back(kvh_frames(n, 1, [](int number) { return 1e-3 * number; }));
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

// Runs one behind the other: which of them were cut off, and for how long nothing was recorded between them.

constexpr std::int64_t kTenth = kSecond / 10;
constexpr std::int64_t kEpoch_s = 1'700'000'000;

class FlightRunsRead : public testing::Test {
 protected:
  enum class End { stopped, killed, killed_between_files };

  // Ten entries a second for three seconds from `from_s` on, in files of a second; then it ends.
  void run(std::int64_t from_s, End end) { run_from((kEpoch_s + from_s) * kSecond, end); }
  // set_ns: by which the wall clock is set one second after the beginning; 0: it is not.
  void run_from(std::int64_t from_ns, End end, std::int64_t set_ns = 0) {
    ArchiveLimits limits;
    limits.file_ns = kSecond;
    auto archive =
        std::make_unique<FlightArchive>(std::make_unique<MemoryFolder>(disk_), limits, some_header());
    std::int64_t now_ns = from_ns;
    for (int n = 0; n < 30; ++n, now_ns += kTenth) {
      std::array<std::uint8_t, sizeof set_ns> set{};
      std::memcpy(set.data(), &set_ns, sizeof set_ns);
      if (n == 10 && set_ns != 0) archive->add({FlightKind::wall, 0, 0, 0, 0}, set);
      archive->add({FlightKind::bytes, 0, 0, 0, now_ns}, numbered(static_cast<std::uint64_t>(n)));
      archive->turn(now_ns, kWall + now_ns, n % 5 == 4);
    }
    if (end == End::killed_between_files) {
      // The file is ended for another, which does not come.
      now_ns += kSecond;
      archive->add({FlightKind::bytes, 0, 0, 0, now_ns}, numbered(99));
      archive->turn(now_ns, kWall + now_ns);
    }
    const MemoryDisk as_it_was = disk_;
    archive->close(now_ns, kWall + now_ns);
    archive.reset();
    if (end == End::stopped) return;
    disk_ = as_it_was;
    disk_.open.clear();
  }
  FlightCounts read() const { return read_back(all_of(disk_)).counts; }

  MemoryDisk disk_;
};

TEST_F(FlightRunsRead, RunsThatWereStoppedAreWholeAndTheTimeBetweenThemIsSaid) {
  run(100, End::stopped);
  run(110, End::stopped);
  run(113, End::stopped);
  const FlightCounts counts = read();
  EXPECT_EQ(counts.runs, 3U);
  EXPECT_EQ(counts.cut_off_runs, 0U);
  EXPECT_EQ(counts.open_files, 0U);
  // The last of a run came 2.9 s after its first.
  EXPECT_NEAR(counts.between_runs_s, 7.1 + 0.1, 1e-9);
  EXPECT_NEAR(counts.longest_between_runs_s, 7.1, 1e-9);
  EXPECT_EQ(losses(counts), std::vector<std::string>{
                                "3 runs of what wrote it, with 7.2 s between them that are not recorded, "
                                "7.1 s at the longest"});
}

// A board without a battery for its clock begins each run in 1970, and is set some seconds later.
TEST_F(FlightRunsRead, OfBoardsWithoutAClockTheTimeBetweenRunsIsByTheClockThatWasSet) {
  run_from(4 * kSecond, End::stopped, kEpoch_s * kSecond);
  run_from(4 * kSecond, End::stopped, (kEpoch_s + 3600) * kSecond);
  EXPECT_NEAR(read().between_runs_s, 3600.0 - 2.9, 1e-6);
  run(7200, End::stopped);
  EXPECT_NEAR(read().longest_between_runs_s, 3600.0 - 2.9, 1e-6);
}

TEST_F(FlightRunsRead, OfAClockThatIsNeverSetNothingIsSaid) {
  run_from(4 * kSecond, End::stopped);
  run(100, End::stopped);
  EXPECT_EQ(read().between_runs_s, 0.0);
}

// Nothing more comes: its file is closed all the same, and whoever is killed then has lost nothing.
TEST_F(FlightRunsRead, ARunThatFellSilentIsWhole) {
  ArchiveLimits limits;
  limits.file_ns = 10 * kSecond;
  {
    FlightArchive archive(std::make_unique<MemoryFolder>(disk_), limits, some_header());
    archive.add({FlightKind::bytes, 0, 0, 0, kSecond}, numbered(1));
    for (std::int64_t now_ns = kSecond; now_ns < 14 * kSecond; now_ns += kTenth)
      archive.turn(now_ns, kWall + now_ns);
    ASSERT_EQ(disk_.files.size(), 1U);
    EXPECT_TRUE(disk_.files.begin()->first.ends_with(".ifr")) << disk_.files.begin()->first;
  }
  run(20, End::stopped);
  EXPECT_EQ(read().cut_off_runs, 0U);
}

TEST_F(FlightRunsRead, RunsThatWereCutOffAreCounted) {
  run(100, End::killed);
  run(110, End::stopped);
  run(120, End::killed_between_files);
  run(130, End::killed);
  run(140, End::stopped);
  FlightCounts counts = read();
  EXPECT_EQ(counts.runs, 5U);
  EXPECT_EQ(counts.cut_off_runs, 3U);
  EXPECT_EQ(counts.open_files, 0U);
  EXPECT_GT(counts.between_runs_s, 4 * 7.0);
  // The last may still be at work.
  run(150, End::killed);
  counts = read();
  EXPECT_EQ(counts.cut_off_runs, 3U);
  EXPECT_EQ(counts.open_files, 1U);
}

}  // namespace
}  // namespace ifog
