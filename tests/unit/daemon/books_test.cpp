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
constexpr unsigned kRuns = 400;
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
  ReaderBooks reader;
  reader.line.bytes = 100;
  reader.driver.bytes_framed = 72;
  reader.driver.bytes_skipped = 20;
  reader.driver.bytes_pending = 8;
  reader.decoded = 3;
  reader.counts.samples = 2;
  reader.counts.repeated = 1;
  const FilterBooks filter{.samples = 2, .sent = 1, .failed = 0, .merged = 1};
  EXPECT_EQ(imbalance(reader, filter), "");
  ReaderBooks wrong = reader;
  wrong.driver.bytes_pending = 7;
  EXPECT_EQ(imbalance(wrong, filter),
            "the books do not balance: 100 bytes read, 72 in frames + 20 skipped + 7 pending");
  wrong = reader;
  wrong.line.frames = 9;
  wrong.driver.frames_good = 5;
  wrong.driver.frames_format = 1;
  wrong.driver.frames_other = 3;
  EXPECT_EQ(imbalance(wrong, filter), "");
  wrong.driver.frames_other = 2;
  EXPECT_EQ(imbalance(wrong, filter),
            "the books do not balance: 9 CAN frames read, 5 decoded + 1 refused + 2 none of the sensor's");
  wrong = reader;
  wrong.counts.repeated = 0;
  EXPECT_EQ(imbalance(wrong, filter), "the books do not balance: 3 samples decoded, 2 accepted + 0 repeated");
  wrong = reader;
  wrong.decoded = 2;
  wrong.counts.samples = 1;
  EXPECT_NE(imbalance(wrong, filter), "");  // more filtered than read
  FilterBooks lost = filter;
  lost.merged = 0;
  EXPECT_EQ(imbalance(reader, lost),
            "the books do not balance: 2 samples, 2 of them filtered: 1 sent + 0 failed + 0 merged");
}

}  // namespace
}  // namespace ifog
