// SPDX-License-Identifier: Apache-2.0
// Runs one behind the other: which of them were cut off, and for how long nothing was recorded between them.
#include <gtest/gtest.h>

#include <array>
#include <cstring>
#include <memory>

#include "tests/unit/flight/archived.h"

namespace ifog {
namespace {

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

TEST_F(FlightRunsRead, OneRunHasNothingToSay) {
  run(100, End::stopped);
  EXPECT_TRUE(losses(read()).empty());
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
