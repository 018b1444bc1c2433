// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/ring.h"

#include <gtest/gtest.h>

#include <cstdint>
#include <thread>

namespace ifog {
namespace {

TEST(Ring, IsFullAtItsCapacityAndEmptyAtTheEnd) {
  Ring<int> ring(5);
  EXPECT_EQ(ring.capacity(), 8U);
  for (int i = 0; i < 8; ++i) {
    int* const slot = ring.claim();
    ASSERT_NE(slot, nullptr);
    *slot = i;
    ring.commit();
  }
  EXPECT_EQ(ring.claim(), nullptr);
  for (int i = 0; i < 8; ++i) {
    ASSERT_NE(ring.front(), nullptr);
    EXPECT_EQ(*ring.front(), i);
    ring.pop();
  }
  EXPECT_EQ(ring.front(), nullptr);
}

TEST(Ring, AClaimedSlotIsNotSeenBeforeItIsCommitted) {
  Ring<int> ring(2);
  *ring.claim() = 7;
  EXPECT_EQ(ring.front(), nullptr);
  ring.commit();
  EXPECT_EQ(*ring.front(), 7);
}

// Under ThreadSanitizer this is the proof that the two sides share nothing unordered.
TEST(Ring, KeepsOrderAndContentBetweenThreads) {
  struct Slot {
    std::uint64_t number, twice;
  };
  Ring<Slot> ring(64);
  constexpr std::uint64_t kCount = 200'000;
  std::thread producer([&ring] {
    for (std::uint64_t i = 0; i < kCount;) {
      Slot* const slot = ring.claim();
      if (slot == nullptr) {
        std::this_thread::yield();
        continue;
      }
      *slot = {i, 2 * i};
      ring.commit();
      ++i;
    }
  });
  std::uint64_t wrong = 0;
  for (std::uint64_t expected = 0; expected < kCount;) {
    const Slot* const slot = ring.front();
    if (slot == nullptr) {
      std::this_thread::yield();
      continue;
    }
    if (slot->number != expected || slot->twice != 2 * expected) ++wrong;
    ring.pop();
    ++expected;
  }
  producer.join();
  EXPECT_EQ(wrong, 0U);
}

}  // namespace
}  // namespace ifog
