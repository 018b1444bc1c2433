// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/processor_share.h"

#include <gtest/gtest.h>

#include <algorithm>
#include <numeric>
#include <vector>

namespace ifog {
namespace {

constexpr std::int64_t kMs = 1'000'000;

// Turns of work_ms every period_ms, or as soon as it may. The part of a minute that was work.
double share_of_a_minute(std::int64_t work_ms, std::int64_t period_ms) {
  ProcessorShare share;
  std::int64_t now = 5'000 * kMs, used = 77 * kMs;
  const std::int64_t begin = now, begin_used = used;
  while (now - begin < 60'000 * kMs) {
    const std::int64_t done = now + work_ms * kMs;
    used += work_ms * kMs;
    now = std::max(done + share.rest_ns(done, [&] { return used; }), now + period_ms * kMs);
  }
  return static_cast<double>(used - begin_used) / static_cast<double>(now - begin);
}

TEST(ProcessorShare, ABabblerKeepsToThreeQuartersAndOthersAreNotHeldUp) {
  EXPECT_NEAR(share_of_a_minute(1, 1), 0.75, 0.01);
  EXPECT_NEAR(share_of_a_minute(30, 31), 0.75, 0.03);
  EXPECT_NEAR(share_of_a_minute(7, 10), 0.7, 1e-3);
  EXPECT_NEAR(share_of_a_minute(1, 5), 0.2, 1e-3);
}

TEST(ProcessorShare, ABurstAfterASilenceIsReadAtOnce) {
  ProcessorShare share;
  std::int64_t used = 0;
  const auto so_far = [&] { return used; };
  EXPECT_EQ(share.rest_ns(1 * kMs, so_far), 0);
  const std::int64_t begin = 3'600'000 * kMs;
  for (int n = 0; n < 100; ++n, used += kMs) EXPECT_EQ(share.rest_ns(begin + n * kMs, so_far), 0) << n;
  EXPECT_GT(share.rest_ns(begin + 100 * kMs, so_far), 0);
}

// Threads of one processor under SCHED_FIFO, as the kernel would run them: the one that has it keeps it until
// it sleeps, and then whoever has waited longest gets it. A turn takes its work_ms; what it waits for comes
// again every period_ms, or is there at once. The parts of a minute that each has had.
struct Thread {
  std::int64_t work_ms, period_ms;
};
std::vector<double> parts_of_a_minute(const std::vector<Thread>& threads) {
  SharedProcessors processors(1);
  std::vector<ProcessorShare> shares(threads.size(), ProcessorShare(&processors));
  std::vector<std::int64_t> used(threads.size(), 0), due(threads.size(), 5'000 * kMs), wakes = due;
  const std::int64_t begin = 5'000 * kMs;
  std::int64_t now = begin;
  while (now - begin < 60'000 * kMs) {
    const auto next = static_cast<std::size_t>(std::min_element(wakes.begin(), wakes.end()) - wakes.begin());
    now = std::max(now, wakes[next]);
    for (bool sleeps = false; !sleeps;) {
      now += threads[next].work_ms * kMs;
      used[next] += threads[next].work_ms * kMs;
      due[next] += threads[next].period_ms * kMs;
      const std::int64_t rest = shares[next].rest_ns(now, [&] { return used[next]; });
      wakes[next] = std::max(now + rest, due[next]);
      sleeps = wakes[next] > now;
    }
  }
  std::vector<double> parts;
  for (const std::int64_t one : used)
    parts.push_back(static_cast<double>(one) / static_cast<double>(now - begin));
  return parts;
}

TEST(ProcessorShare, BabblersOfOneProcessorLeaveOthersTheirs) {
  for (std::size_t babblers = 1; babblers <= 5; ++babblers) {
    std::vector<Thread> threads(babblers, {1, 0});
    threads.push_back({1, 50});  // a sensor that is itself
    const std::vector<double> parts = parts_of_a_minute(threads);
    const double together = std::accumulate(parts.begin(), parts.end(), 0.0);
    EXPECT_GT(together, 0.7) << babblers;
    EXPECT_LT(together, 0.85) << babblers;
    for (std::size_t i = 0; i < babblers; ++i)
      EXPECT_GT(parts[i], 0.3 / static_cast<double>(babblers)) << i << " of " << babblers;
    EXPECT_NEAR(parts.back(), 0.02, 2e-3) << babblers;
  }
}

TEST(ProcessorShare, NobodyStandsBackWhileThreeQuartersAreNotTaken) {
  const std::vector<double> parts = parts_of_a_minute({{4, 10}, {3, 10}});
  EXPECT_NEAR(parts[0], 0.4, 1e-3);
  EXPECT_NEAR(parts[1], 0.3, 1e-3);
}

}  // namespace
}  // namespace ifog
