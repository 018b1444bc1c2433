// SPDX-License-Identifier: Apache-2.0
// A recording that is torn or changed: every loss is counted, and nothing false comes out of it.
#include "tests/unit/flight/recordings.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

using Bytes = std::vector<std::uint8_t>;

// Entries in small blocks: header, then one block a turn.
Bytes recording(std::uint64_t entries, std::uint64_t a_block, bool closed) {
  MemoryDisk disk;
  FlightArchive archive(std::make_unique<MemoryFolder>(disk), {}, some_header());
  for (std::uint64_t n = 0; n < entries; ++n) {
    archive.add({FlightKind::bytes, 0, 0, 0, static_cast<std::int64_t>(n)}, numbered(n));
    if (n % a_block == a_block - 1) archive.turn(static_cast<std::int64_t>(n), 0, true);
  }
  archive.turn(static_cast<std::int64_t>(entries), 0, true);
  const Bytes open = all_of(disk);
  archive.close(static_cast<std::int64_t>(entries), 0);
  return closed ? all_of(disk) : open;
}

// What came out is what went in, in order, with samples missing only where a hole was reported.
void expect_true_but_for_holes(const ReadBack& read) {
  std::uint64_t before = 0;
  bool first = true;
  for (std::size_t i = 0; i < read.payloads.size(); ++i) {
    ASSERT_GE(read.payloads[i].size(), 8U);
    std::uint64_t n = 0;
    std::memcpy(&n, read.payloads[i].data(), sizeof n);
    ASSERT_EQ(read.payloads[i], numbered(n));
    const bool hole = std::find(read.holes.begin(), read.holes.end(), i) != read.holes.end();
    ASSERT_TRUE(hole || n == (first ? 0 : before + 1)) << "entry " << n << " after " << before;
    ASSERT_TRUE(first || n > before);
    before = n;
    first = false;
  }
}

TEST(FlightDamage, ATornTailAtEveryByteGivesAllBlocksBeforeIt) {
  constexpr std::uint64_t kEntries = 40, kABlock = 4;
  const Bytes whole = recording(kEntries, kABlock, true);
  ASSERT_EQ(read_back(whole).payloads.size(), kEntries);
  ASSERT_TRUE(losses(read_back(whole).counts).empty());
  // Where each block ends, by its own length.
  std::vector<std::size_t> ends;
  for (std::size_t at = 0; at < whole.size();) {
    std::uint32_t stored = 0;
    std::memcpy(&stored, whole.data() + at + 8, sizeof stored);
    at += kBlockHead + stored + kBlockTail;
    ends.push_back(at);
  }
  ASSERT_EQ(ends.size(), 1 + kEntries / kABlock + 1);
  for (std::size_t length = ends[0]; length < whole.size(); ++length) {
    const ReadBack read =
        read_back(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length)));
    const auto blocks =
        static_cast<std::size_t>(std::upper_bound(ends.begin(), ends.end(), length) - ends.begin());
    ASSERT_EQ(read.payloads.size(), (blocks - 1) * kABlock) << length;
    ASSERT_EQ(read.counts.torn_bytes, length - ends[blocks - 1]) << length;
    ASSERT_EQ(read.counts.damaged_bytes, 0U) << length;
    ASSERT_EQ(read.counts.open_files, 1U) << length;
    expect_true_but_for_holes(read);
  }
  // Before its header is whole it is no recording.
  for (std::size_t length = 0; length < ends[0]; ++length)
    EXPECT_THROW(read_back(Bytes(whole.begin(), whole.begin() + static_cast<std::ptrdiff_t>(length))),
                 std::runtime_error);
}

TEST(FlightDamage, EveryFlippedBitIsCountedAndCostsOneBlock) {
  constexpr std::uint64_t kEntries = 24, kABlock = 4;
  const Bytes whole = recording(kEntries, kABlock, true);
  std::uint32_t header = 0;
  std::memcpy(&header, whole.data() + 8, sizeof header);
  for (std::size_t byte = kBlockHead + header + kBlockTail; byte < whole.size(); ++byte)
    for (int bit = 0; bit < 8; ++bit) {
      Bytes flipped = whole;
      flipped[byte] = static_cast<std::uint8_t>(flipped[byte] ^ (1U << bit));
      const ReadBack read = read_back(flipped);
      expect_true_but_for_holes(read);
      // In one of the data blocks, or in the end, which has none.
      const std::size_t lost = kEntries - read.payloads.size();
      ASSERT_TRUE(lost == 0 || lost == kABlock) << byte << " bit " << bit;
      ASSERT_EQ(read.counts.missing_entries, lost);
      ASSERT_GT(read.counts.damaged_bytes + read.counts.torn_bytes, 0U);
      ASSERT_EQ(read.counts.open_files, lost == 0 ? 1U : 0U);
    }
}

TEST(FlightDamage, PiecesCutOutPutInAndChangedNeverLookLikeData) {
  const Bytes whole = recording(300, 7, true), other = recording(300, 7, true);
  std::mt19937 random(20240611);
  const auto below = [&](std::size_t n) {
    return std::uniform_int_distribution<std::size_t>(0, n - 1)(random);
  };
  int damaged = 0;
  for (int round = 0; round < 1500; ++round) {
    Bytes bytes = whole;
    const std::size_t at = 800 + below(bytes.size() - 1600), length = 1 + below(400);
    const auto from = bytes.begin() + static_cast<std::ptrdiff_t>(at);
    switch (below(4)) {
      case 0:
        bytes.erase(from, from + static_cast<std::ptrdiff_t>(length));
        break;
      case 1: {  // of another recording: good blocks, of another file
        const std::size_t piece = 800 + below(other.size() - 1600);
        bytes.insert(
            from, other.begin() + static_cast<std::ptrdiff_t>(piece),
            other.begin() + static_cast<std::ptrdiff_t>(std::min(other.size() - 1, piece + 3 * length)));
        break;
      }
      case 2:  // of itself: good blocks, in another place
        bytes.insert(from, whole.begin() + 800,
                     whole.begin() + static_cast<std::ptrdiff_t>(800 + 3 * length));
        break;
      default:
        for (std::size_t i = 0; i < length; ++i) bytes[at + i] = static_cast<std::uint8_t>(random());
    }
    const ReadBack read = read_back(bytes);
    expect_true_but_for_holes(read);
    damaged += read.counts.damaged_bytes + read.counts.torn_bytes > 0 ? 1 : 0;
    ASSERT_TRUE(bytes == whole || !losses(read.counts).empty());
  }
  EXPECT_GT(damaged, 1400);
}

TEST(FlightDamage, RecordingsBehindOneAnotherAreReadAsOne) {
  Bytes both = recording(20, 4, true);
  const Bytes open = recording(12, 4, false), torn(open.begin(), open.end() - 3);
  both.insert(both.end(), torn.begin(), torn.end());
  const Bytes last = recording(8, 4, true);
  both.insert(both.end(), last.begin(), last.end());
  const ReadBack read = read_back(both);
  EXPECT_EQ(read.headers.size(), 3U);
  EXPECT_EQ(read.payloads.size(), 20U + 8U + 8U);  // a block of four is torn
  // Other runs: what is begun at the end of one does not continue in the next.
  EXPECT_EQ(read.holes, (std::vector<std::size_t>{20, 28}));
  EXPECT_EQ(read.counts.cut_off_runs, 1U);
  EXPECT_EQ(read.counts.open_files, 0U);
  EXPECT_GT(read.counts.torn_bytes, 0U);
  EXPECT_EQ(read.counts.damaged_bytes, 0U);
}

}  // namespace
}  // namespace ifog
