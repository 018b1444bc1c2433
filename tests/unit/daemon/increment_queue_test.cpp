// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/increment_queue.h"
#include "tests/unit/test.h"

namespace ifog {
namespace {

void push(IncrementQueue& queue, std::uint64_t sequence) {
  Increment& increment = queue.next();
  increment = Increment{};
  increment.sequence = sequence;
  increment.dt_s = 1.0;
  increment.covered_s[0] = 1.0;
  increment.delta_theta_rad[0] = static_cast<double>(sequence);  // whole numbers: sums are exact
  increment.valid_axes = 1;
  queue.push();
}

TEST(IncrementQueue, AnOverflowMergesAndLosesNoAngle) {
  IncrementQueue queue(4, IncrementQueue::WhenFull::merge);
  for (std::uint64_t n = 1; n <= 100; ++n) push(queue, n);
  EXPECT_EQ(queue.overflows(), 1U);
  EXPECT_EQ(queue.merged(), 95U);  // four in the ring, 96 in one: the first of those is merged into nothing
  double angle = 0.0, time = 0.0;
  std::uint64_t samples = 0, last = 0;
  const auto drain = [&] {
    for (const Increment* in = queue.front(); in != nullptr; in = queue.front()) {
      EXPECT_GT(in->sequence, last);
      last = in->sequence;
      angle += in->delta_theta_rad[0];
      time += in->dt_s;
      samples += in->samples;
      queue.pop();
    }
  };
  drain();
  EXPECT_EQ(samples, 4U);
  push(queue, 101);  // order: the merged one goes in before it
  queue.flush();
  drain();
  queue.close();
  drain();
  EXPECT_EQ(samples, 101U);
  EXPECT_EQ(last, 101U);
  EXPECT_EQ(angle, 101.0 * 102.0 / 2.0);
  EXPECT_EQ(time, 101.0);
  EXPECT_TRUE(queue.finished());
}

// The consumer's work is done by two threads in turn, and a third calls the consumer at any moment. What they
// share is plain: ThreadSanitizer sees whether the place is handed over properly.
TEST(IncrementQueue, AProducerThatBorrowsTheConsumersPlaceKeepsTheOrder) {
  IncrementQueue queue(16, IncrementQueue::WhenFull::wait);
  constexpr std::uint64_t kCount = 50'000;
  std::uint64_t taken = 0, borrowed = 0, woken = 0;
  const auto take = [&] {
    const Increment* const in = queue.front();
    if (in == nullptr) return false;
    EXPECT_EQ(in->sequence, ++taken);
    queue.pop();
    return true;
  };
  std::atomic<bool> over{false};
  std::thread caller([&] {
    while (!over.load()) {
      queue.notify();
      std::this_thread::yield();
    }
  });
  std::thread producer([&] {
    for (std::uint64_t n = 1; n <= kCount; ++n) {
      push(queue, n);
      if (n % 3 == 0 || !queue.flush_or_borrow(4)) continue;
      ++borrowed;
      // Now and then something is left over, which wakes the consumer.
      for (std::uint64_t most = n % 5; most > 0 && take();) --most;
      queue.give_back();
    }
    queue.close();
  });
  while (!queue.finished()) {
    if (take())
      ++woken;
    else
      queue.wait();
  }
  producer.join();
  over.store(true);
  caller.join();
  EXPECT_EQ(taken, kCount);
  EXPECT_GT(borrowed, 0U);
  EXPECT_GT(woken, 0U);
}

TEST(IncrementQueue, WhatABorrowerLeavesWakesTheConsumer) {
  IncrementQueue queue(16, IncrementQueue::WhenFull::merge);
  std::atomic<std::uint64_t> taken{0};
  std::thread consumer([&] {
    while (!queue.finished()) {
      if (queue.front() == nullptr) {
        queue.wait();
        continue;
      }
      queue.pop();
      taken.fetch_add(1);
    }
  });
  for (std::uint64_t n = 1; n <= 200; ++n) {
    push(queue, n);
    if (queue.flush_or_borrow(16)) queue.give_back();  // nothing is taken
    while (taken.load() < n) std::this_thread::yield();
  }
  queue.close();
  consumer.join();
  EXPECT_EQ(taken.load(), 200U);
}

TEST(IncrementQueue, MoreThanTheBorrowerWantsGoesToTheConsumer) {
  IncrementQueue queue(16, IncrementQueue::WhenFull::merge);
  for (std::uint64_t n = 1; n <= 3; ++n) push(queue, n);
  std::atomic<int> taken{0};
  std::atomic<bool> waiting{false}, offered{false};
  std::thread consumer([&] {
    for (; queue.front() != nullptr; queue.pop()) taken.fetch_add(1);
    waiting.store(true);
    while (!queue.finished()) {
      queue.wait();
      // What a consumer that had not yet fallen asleep took on its way would not be there to refuse for.
      while (!offered.load()) std::this_thread::yield();
      for (; queue.front() != nullptr; queue.pop()) taken.fetch_add(1);
    }
  });
  while (!waiting.load()) std::this_thread::yield();
  for (std::uint64_t n = 4; n <= 6; ++n) push(queue, n);
  const bool borrowed = queue.flush_or_borrow(2);
  EXPECT_FALSE(borrowed);
  if (borrowed) queue.give_back();
  offered.store(true);
  while (taken.load() < 6) std::this_thread::yield();
  queue.close();
  consumer.join();
}

}  // namespace
}  // namespace ifog
