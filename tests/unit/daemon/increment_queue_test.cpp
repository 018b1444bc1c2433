#include "daemon/pipeline/increment_queue.h"

#include <gtest/gtest.h>

#include <thread>

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

TEST(IncrementQueue, AMergeCannotStarveInAFullRing) {
  IncrementQueue queue(2, IncrementQueue::WhenFull::merge);
  double angle = 0.0;
  std::uint64_t pushed = 0;
  for (int round = 0; round < 1000; ++round) {
    for (int i = 0; i < 3; ++i) push(queue, ++pushed);
    if (const Increment* const in = queue.front()) {
      angle += in->delta_theta_rad[0];
      queue.pop();
    }
  }
  std::thread closer([&queue] { queue.close(); });
  while (!queue.finished()) {
    if (const Increment* const in = queue.front()) {
      angle += in->delta_theta_rad[0];
      queue.pop();
    } else {
      queue.wait();
    }
  }
  closer.join();
  EXPECT_EQ(angle, static_cast<double>(pushed) * static_cast<double>(pushed + 1) / 2.0);
  EXPECT_GT(queue.merged(), 0U);
}

TEST(IncrementQueue, ASourceThatKeepsItsBytesWaitsInsteadOfMerging) {
  IncrementQueue queue(8, IncrementQueue::WhenFull::wait);
  constexpr std::uint64_t kCount = 20'000;
  std::thread producer([&queue] {
    for (std::uint64_t n = 1; n <= kCount; ++n) {
      push(queue, n);
      if (n % 7 == 0) queue.flush();
    }
    queue.close();
  });
  std::uint64_t expected = 1;
  while (!queue.finished()) {
    if (const Increment* const in = queue.front()) {
      ASSERT_EQ(in->sequence, expected++);
      queue.pop();
    } else {
      queue.wait();
    }
  }
  producer.join();
  EXPECT_EQ(expected, kCount + 1);
  EXPECT_EQ(queue.merged(), 0U);
}

}  // namespace
}  // namespace ifog
