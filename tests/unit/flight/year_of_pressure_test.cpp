// SPDX-License-Identifier: Apache-2.0
// A recorder through a year on a disk that others fill and empty, that is slow for up to a day, that goes and
// comes back, as it was or empty.
#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// A recorder on such a disk, which is killed and started again now and then.
class HardYear {
 public:
  static constexpr std::int64_t kStep = 600 * kSecond, kLength = 365 * kDay;

  HardYear() {
    limits.bytes = 400'000;
    limits.file_bytes = 20'000;
    limits.file_ns = 6 * 3600 * kSecond;
    limits.age_ns = 5 * kDay;
    limits.flush_ns = 60 * kSecond;
    start();
  }
  // Much in the first half, where the limit of bytes is what counts, little in the second: that of days.
  static std::vector<std::uint8_t> payload(std::uint64_t n) {
    return numbered(n, n < kLength / kStep * 4 / 2 ? 400 : 20);
  }
  void step(std::int64_t now_ns) {
    disk.now_ns = kWall + now_ns;
    if (chance(0.002)) disk.room = disk.used() + static_cast<std::uint64_t>(random_() % 3000);
    if (chance(0.02)) disk.room = UINT64_MAX;
    disk.cuts_back = !chance(0.1);
    trouble(now_ns < kLength - kDay);
    for (int i = 0; i < 4; ++i, ++count) {
      when[count] = now_ns;
      // As the tape does it: what finds no room is dropped, and counted.
      if (archive->full())
        left_out.insert(count);
      else
        archive->add({FlightKind::bytes, 0, 0, 0, now_ns}, payload(added_.emplace_back(count)));
    }
    if (slow_steps_ == 0) {
      archive->turn(now_ns, disk.now_ns);
      archive->turn(now_ns + 60 * kSecond, disk.now_ns + 60 * kSecond);
    } else if (archive->full()) {
      ++overflows;
    }
    fullest = std::max(fullest, disk.used());
    const bool refuses = archive->error() != 0;
    refusals += refuses && !refused_ ? 1 : 0;
    recoveries += !refuses && refused_ ? 1 : 0;
    refused_ = refuses;
    if (chance(0.003)) kill();
  }

  MemoryDisk disk;
  ArchiveLimits limits;
  std::unique_ptr<FlightArchive> archive;
  std::set<std::uint64_t> left_out;
  std::map<std::uint64_t, std::int64_t> when;
  std::uint64_t count = 0, fullest = 0;
  int refusals = 0, recoveries = 0, kills = 0;
  int outages = 0, emptied = 0, slow_times = 0, overflows = 0;

 private:
  // A write that lasts for hours: no turn ends meanwhile. A card that is pulled out and put in again, and one
  // that has been wiped.
  void trouble(bool begins) {
    if (slow_steps_ > 0) --slow_steps_;
    if (begins && slow_steps_ == 0 && chance(0.001)) {
      slow_steps_ = 1 + static_cast<int>(random_() % 144);
      ++slow_times;
    }
    if (begins && disk.gone == 0 && chance(0.001)) {
      disk.gone = chance(0.5) ? EIO : EROFS;
      ++outages;
    }
    if (disk.gone != 0 && (!begins || chance(0.05))) disk.gone = 0;
    if (begins && chance(0.0005)) wipe();
  }
  void wipe() {
    ++emptied;
    disk.files.clear();
    left_out.insert(added_.begin(), added_.end() - static_cast<std::ptrdiff_t>(archive->entries_waiting()));
    added_.erase(added_.begin(), added_.end() - static_cast<std::ptrdiff_t>(archive->entries_waiting()));
  }
  bool chance(double p) { return std::uniform_real_distribution<>(0.0, 1.0)(random_) < p; }
  void start() {
    archive = std::make_unique<FlightArchive>(std::make_unique<MemoryFolder>(disk), limits, some_header());
  }
  // What waited has not reached the disk.
  void kill() {
    ++kills;
    const MemoryDisk at_death = disk;
    for (std::uint64_t waited = archive->entries_waiting(); waited > 0; --waited) {
      left_out.insert(added_.back());
      added_.pop_back();
    }
    archive.reset();
    disk = at_death;
    disk.open.clear();
    start();
    refused_ = false;
  }

  std::mt19937 random_{365};
  std::vector<std::uint64_t> added_;
  bool refused_ = false;
  int slow_steps_ = 0;
};

// Limits are held at every moment, each refusal ends when there is room, and what is on the disk is what was
// added, without a gap that is not known.
TEST(FlightArchive, AYearOfDiskPressure) {
  HardYear year;
  for (std::int64_t now_ns = 0; now_ns < HardYear::kLength; now_ns += HardYear::kStep) year.step(now_ns);
  EXPECT_LE(year.fullest, year.limits.bytes);
  EXPECT_GT(year.fullest, year.limits.bytes * 9 / 10);
  EXPECT_GT(year.refusals, 30);
  EXPECT_GT(year.recoveries, 25);
  EXPECT_GT(year.kills, 100);
  EXPECT_GT(year.outages, 20);
  EXPECT_GT(year.emptied, 10);
  EXPECT_GT(year.slow_times, 20);
  EXPECT_GT(year.overflows, 20);
  year.disk.room = UINT64_MAX;
  year.archive->close(HardYear::kLength, kWall + HardYear::kLength);
  const ReadBack read = read_back(all_of(year.disk));
  EXPECT_EQ(read.counts.damaged_bytes, 0U);
  ASSERT_GT(read.payloads.size(), 1000U);
  std::uint64_t first = 0, before = 0, holes = 0;
  std::memcpy(&first, read.payloads.front().data(), 8);
  for (std::size_t i = 0; i < read.payloads.size(); ++i) {
    std::uint64_t number = 0;
    std::memcpy(&number, read.payloads[i].data(), 8);
    ASSERT_EQ(read.payloads[i], HardYear::payload(number));
    ASSERT_TRUE(i == 0 || number > before);
    for (std::uint64_t gone = before + 1; i > 0 && gone < number; ++gone)
      holes += year.left_out.contains(gone) ? 0 : 1;
    before = number;
  }
  EXPECT_EQ(holes, 0U);
  EXPECT_EQ(before, year.count - 1);
  // The last five days, and no more than a file's time older.
  EXPECT_GE(year.when[first], HardYear::kLength - year.limits.age_ns - year.limits.file_ns - HardYear::kStep);
}

}  // namespace
}  // namespace ifog
