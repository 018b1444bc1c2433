// SPDX-License-Identifier: Apache-2.0
// Whatever happens, the books balance at every look, and the published angle is what the intact frames say.
#include "daemon/health/books.h"
#include "tests/unit/daemon/faults/random_faults.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

// tests/bench/books has thousands of them.
#if defined(__SANITIZE_THREAD__) || defined(__SANITIZE_ADDRESS__)
constexpr unsigned kRuns = 60;
#else
constexpr unsigned kRuns = 250;
#endif

TEST(Books, BalanceWhateverHappensAndTheAngleIsThatOfTheIntactFrames) {
  for (unsigned seed = 0; seed < kRuns && !HasFailure(); ++seed)
    EXPECT_EQ(random_faults(seed), "") << "seed " << seed;
}

// A hundred runs more must not hold more than the first ones left behind: the log, what malloc keeps for
// threads that may come.
TEST(Books, NoRunLeavesADescriptorOrMemoryBehind) {
  constexpr unsigned kWarm = 20, kMore = 100;
  for (unsigned seed = 0; seed < kWarm; ++seed) ASSERT_EQ(random_faults(seed), "") << "seed " << seed;
  const Held before = held_by_process();
  for (unsigned seed = 0; seed < kMore; ++seed) ASSERT_EQ(random_faults(seed), "") << "seed " << seed;
  const Held after = held_by_process();
  EXPECT_EQ(after.descriptors, before.descriptors);
  EXPECT_LT(after.bytes, before.bytes + 65536);  // a run takes some 300 kB
}

TEST(Books, AnImbalanceIsSaidWithItsNumbers) {
  using Change = std::function<void(ReaderBooks&, FilterBooks&)>;
  const Change can = [](ReaderBooks& r, FilterBooks&) {
    r.line.frames = 9;
    r.driver.frames_good = 5;
    r.driver.frames_format = 1;
    r.driver.frames_other = 3;
  };
  for (const auto& [change, said] : std::initializer_list<std::pair<Change, const char*>>{
           {[](ReaderBooks&, FilterBooks&) {}, ""},
           {can, ""},
           {[](ReaderBooks&r, FilterBooks&) { r.driver.bytes_pending = 7; },
            "100 bytes read, 72 in frames + 20 skipped + 7 pending"},
           {[&](ReaderBooks&r, FilterBooks&f) { can(r, f), r.driver.frames_other = 2; },
            "9 CAN frames read, 5 decoded + 1 refused + 2 none of the sensor's"},
           {[](ReaderBooks&r, FilterBooks&) { r.counts.repeated = 0; },
            "3 samples decoded, 2 accepted + 0 repeated"},
           {[](ReaderBooks&r, FilterBooks&) { r.decoded = 2, r.counts.samples = 1; },
            "1 samples, 2 of them filtered"},
           {[](ReaderBooks&, FilterBooks&f) { f.merged = 0; },
            "2 samples, 2 of them filtered: 1 sent + 0 failed + 0 merged"}}) {
    ReaderBooks reader;
    reader.line.bytes = 100;
    reader.driver.bytes_framed = 72;
    reader.driver.bytes_skipped = 20;
    reader.driver.bytes_pending = 8;
    reader.decoded = 3;
    reader.counts.samples = 2;
    reader.counts.repeated = 1;
    FilterBooks filter{.samples = 2, .sent = 1, .failed = 0, .merged = 1};
    change(reader, filter);
    EXPECT_TRUE(test::has(imbalance(reader, filter), said));
    EXPECT_EQ(imbalance(reader, filter).empty(), std::string_view(said).empty()) << said;
  }
}

}  // namespace
}  // namespace ifog
