// SPDX-License-Identifier: Apache-2.0
// Files that begin, end and go; a disk that is full, damaged, or shared with others.
#include <unistd.h>

#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

struct Bench {
  explicit Bench(ArchiveLimits limits)
      : archive(std::make_unique<MemoryFolder>(disk), limits, some_header()) {}
  void add(std::uint64_t n) { archive.add({FlightKind::bytes, 0, 0, 0, now_ns}, numbered(n)); }
  void turn() {
    disk.now_ns = kWall + now_ns;
    archive.turn(now_ns, kWall + now_ns);
  }
  MemoryDisk disk;
  FlightArchive archive;
  std::int64_t now_ns = 0;
};

TEST(FlightArchive, WhatWaitsIsWrittenWithinASecondAndReadableWhileItIsOpen) {
  Bench bench({});
  bench.add(0);
  bench.turn();
  EXPECT_TRUE(bench.disk.files.empty());  // not due
  bench.now_ns = kSecond;
  bench.turn();
  ASSERT_EQ(bench.disk.files.size(), 1U);
  EXPECT_EQ(bench.disk.files.begin()->first, "00000001-20231114T221321Z.ifr.open");
  EXPECT_EQ(numbers(read_back(all_of(bench.disk))), counting(0, 1));
  bench.archive.close(bench.now_ns, kWall);
  EXPECT_EQ(bench.disk.files.begin()->first, "00000001-20231114T221321Z.ifr");
  EXPECT_TRUE(losses(read_back(all_of(bench.disk)).counts).empty());
}

// Killed at any moment, also as a file begins or ends: by the recorder, which comes every 250 ms, with a
// tenth of a second for the disk.
TEST(FlightArchive, WhatIsKilledMissesASecondAtMost) {
  ArchiveLimits limits;
  limits.file_ns = 1'300'000'000;
  Bench bench(limits);
  std::uint64_t added = 0;
  for (std::int64_t turn_ns = 0; turn_ns < 20 * kSecond; turn_ns += kSecond / 4) {
    // What arrived since the turn before, 500 a second.
    for (; bench.now_ns < turn_ns; bench.now_ns += kSecond / 500) bench.add(added++);
    bench.turn();
    const auto waiting = static_cast<std::int64_t>(bench.archive.entries_waiting());
    const std::int64_t oldest_ns = turn_ns - waiting * (kSecond / 500);
    EXPECT_LE(turn_ns + kSecond / 4 - oldest_ns, kSecond * 9 / 10) << turn_ns;
  }
  EXPECT_GT(bench.disk.files.size(), 10U);
}

// A file begins with the latest values, so that it can be read by itself.
TEST(FlightArchive, EachFileBeginsWithTheStateOfTheChannels) {
  ArchiveLimits limits;
  limits.file_ns = 10 * kSecond;
  Bench bench(limits);
  const double first = 12.5, second = 13.5;
  const auto put = [&](const double& value) {
    bench.archive.add({FlightKind::channel, 0, 1, 0, bench.now_ns},
                      {reinterpret_cast<const std::uint8_t*>(&value), sizeof value});
  };
  put(first);
  for (std::uint64_t n = 0; n < 30; ++n) {
    bench.now_ns += 2 * kSecond;
    bench.add(n);
    if (n == 17) put(second);
    bench.turn();
  }
  bench.archive.close(bench.now_ns, kWall);
  ASSERT_GT(bench.disk.files.size(), 4U);
  double last = 0.0;
  for (const auto& [name, bytes] : bench.disk.files) {
    FlightReader reader(bytes);
    ASSERT_EQ(reader.next(), FlightReader::Item::header);
    ASSERT_EQ(reader.next(), FlightReader::Item::entry);
    ASSERT_EQ(reader.entry().head.kind, FlightKind::channel) << name;
    ASSERT_EQ(reader.entry().head.index, 1) << name;
    double value = 0.0;
    ASSERT_TRUE(reader.entry().value(value));
    EXPECT_TRUE(value == first || value == second);
    EXPECT_GE(value, last);
    last = value;
  }
  EXPECT_EQ(last, second);
}

// Somebody removes the file in work: what it held is lost and known to be, what waited and what comes goes
// into another one, and a reader says that one is missing.
TEST(FlightArchive, AFileThatIsTakenAwayIsCountedAndTheNextGoesOn) {
  ArchiveLimits limits;
  limits.file_ns = 100 * kSecond;
  Bench bench(limits);
  auto seconds = [&, n = std::uint64_t{0}](int count) mutable {
    for (int i = 0; i < count; ++i) {
      bench.now_ns += kSecond;
      bench.add(n++);
      bench.turn();
    }
  };
  seconds(150);
  const std::uint64_t before = numbers(read_back(all_of(bench.disk))).size();
  bench.disk.files.erase(bench.disk.open);
  const std::uint64_t left = numbers(read_back(all_of(bench.disk))).size();
  ASSERT_LT(left, before);
  seconds(20);
  EXPECT_EQ(bench.archive.error(), 0);
  EXPECT_EQ(bench.archive.lost_with_files().deliveries, before - left);
  EXPECT_EQ(bench.archive.close(bench.now_ns, kWall + bench.now_ns), 0U);
  const ReadBack read = read_back(all_of(bench.disk));
  EXPECT_EQ(read.payloads.size(), 170 - (before - left));
  EXPECT_EQ(read.counts.missing_files, 1U);
  EXPECT_EQ(read.holes, std::vector<std::size_t>{left});
}

// On a real disk: who comes second is refused, and has the folder once the first is gone.
TEST(FlightArchive, OneRecorderAFolder) {
  const test::OwnFolder own;
  const std::string path = own.path("record");
  std::vector<FlightFolder::File> files;
  auto first = make_flight_folder(path);
  EXPECT_EQ(first->list(files), 0);
  EXPECT_EQ(first->list(files), 0);
  FlightArchive second(make_flight_folder(path), {}, some_header());
  second.add({FlightKind::bytes, 0, 0, 0, 1}, numbered(1));
  second.turn(kSecond, kWall, true);
  EXPECT_EQ(second.complaint(), "another recorder writes into it (expected a folder of its own)");
  EXPECT_EQ(second.entries_waiting(), 1U);
  // Removed and made again it is another folder, which is locked as well.
  std::filesystem::remove_all(path);
  EXPECT_EQ(first->list(files), 0);
  second.turn(3 * kSecond, kWall, true);
  EXPECT_EQ(second.error(), EBUSY);
  first.reset();
  second.turn(5 * kSecond, kWall, true);
  EXPECT_EQ(second.error(), 0);
  // A file that is taken away on a real disk.
  std::filesystem::remove_all(path);
  second.add({FlightKind::bytes, 0, 0, 0, 1}, numbered(2));
  second.turn(7 * kSecond, kWall, true);
  EXPECT_EQ(second.error(), 0);
  EXPECT_EQ(second.lost_with_files().deliveries, 1U);
  EXPECT_EQ(second.close(8 * kSecond, kWall), 0U);
}

// As the folders of those that did not lock have them: read as one they are two gyros.
TEST(FlightArchive, RunsThatOverlapAreTold) {
  MemoryDisk disk;
  for (const std::int64_t begin_ns : {0 * kSecond, 5 * kSecond, 100 * kSecond}) {
    FlightArchive archive(std::make_unique<MemoryFolder>(disk), {}, some_header());
    archive.add({FlightKind::bytes, 0, 0, 0, begin_ns}, numbered(1));
    archive.turn(begin_ns, kWall + begin_ns, true);
    archive.close(begin_ns + 20 * kSecond, kWall + begin_ns + 20 * kSecond);
  }
  const ReadBack read = read_back(all_of(disk));
  EXPECT_EQ(read.counts.early_files, 1U);
  ASSERT_EQ(losses(read.counts).size(), 2U);  // and that they are three
  EXPECT_TRUE(test::has(losses(read.counts)[1], "two recorders wrote at once"));
}

TEST(FlightArchive, WhatLcmLostIsNoFaultOfTheDisk) {
  MemoryDisk disk;
  FlightHeader header = some_header();
  header.carries = FlightHeader::Carries::messages;
  FlightArchive archive(std::make_unique<MemoryFolder>(disk), {}, header);
  const std::uint64_t lost[2] = {88, 0};
  archive.add({FlightKind::lost, 0, 0, 0, 1}, {reinterpret_cast<const std::uint8_t*>(lost), sizeof lost});
  archive.close(1, kWall);
  EXPECT_EQ(losses(read_back(all_of(disk)).counts),
            std::vector<std::string>{"88 messages are not in the recording: lost on LCM on the way to it, or "
                                     "the disk was slow or full"});
}

TEST(FlightArchive, ABlockHalfWrittenOnAFullDiskIsWrittenAnewInAnotherFile) {
  Bench bench({});
  bench.disk.cuts_back = false;
  for (std::uint64_t n = 0; n < 100; ++n) {
    bench.now_ns += kSecond;
    if (n == 50) bench.disk.room = bench.disk.used() + 40;
    if (n == 80) bench.disk.room = UINT64_MAX;
    bench.add(n);
    bench.turn();
  }
  bench.archive.close(bench.now_ns, kWall);
  const ReadBack read = read_back(all_of(bench.disk));
  EXPECT_EQ(numbers(read), counting(0, 100));
  EXPECT_EQ(read.counts.torn_bytes, 40U);
  EXPECT_EQ(read.counts.open_files, 1U);
  EXPECT_EQ(bench.disk.files.size(), 2U);
}

// The wall clock of a computer without a battery: 1970 at the start, right later. It removes nothing.
TEST(FlightArchive, AClockThatIsSetRemovesNoFile) {
  MemoryDisk disk;
  ArchiveLimits limits;
  limits.file_ns = 10 * kSecond;
  limits.age_ns = kDay;
  FlightArchive archive(std::make_unique<MemoryFolder>(disk), limits, some_header());
  for (std::uint64_t n = 0; n < 200; ++n) {
    const std::int64_t now_ns = static_cast<std::int64_t>(n) * kSecond;
    disk.now_ns = (n < 100 ? 0 : kWall) + now_ns;
    archive.add({FlightKind::bytes, 0, 0, 0, now_ns}, numbered(n));
    archive.turn(now_ns, disk.now_ns);
  }
  archive.close(200 * kSecond, kWall + 200 * kSecond);
  EXPECT_EQ(archive.files_removed(), 0U);
  EXPECT_EQ(numbers(read_back(all_of(disk))), counting(0, 200));
  // The next day's recorder finds files of an unknown age, and leaves those, too.
  FlightArchive next(std::make_unique<MemoryFolder>(disk), limits, some_header());
  next.turn(0, kWall + 300 * kSecond);
  EXPECT_EQ(next.files_removed(), 0U);
}

// What is numbered as no recorder ever comes to: the next number would not follow it.
TEST(FlightArchive, AFileOfOthersWithAHugeNumberIsLeftAlone) {
  MemoryDisk disk;
  const std::vector<std::string> of_others{"18446744073709551615-20260101T000000Z.ifr",
                                           "18446744073709551615-20260101T000000Z.ifr.open",
                                           "99999999999999999999999-x.ifr", "7.ifr", "-1-x.ifr"};
  for (const std::string& name : of_others) disk.files[name] = {1, 2, 3};
  ArchiveLimits limits;
  limits.bytes = 2000;
  limits.file_bytes = 500;
  FlightArchive archive(std::make_unique<MemoryFolder>(disk), limits, some_header());
  for (std::uint64_t n = 0; n < 200; ++n) {
    archive.add({FlightKind::bytes, 0, 0, 0, static_cast<std::int64_t>(n) * kSecond}, numbered(n));
    archive.turn(static_cast<std::int64_t>(n) * kSecond, kWall + static_cast<std::int64_t>(n) * kSecond);
  }
  archive.close(200 * kSecond, kWall + 200 * kSecond);
  EXPECT_GT(archive.files_removed(), 10U);
  EXPECT_LT(disk.used(), 2000U + 5 * 3);
  for (const std::string& name : of_others) EXPECT_TRUE(disk.files.contains(name)) << name;
}

}  // namespace
}  // namespace ifog
