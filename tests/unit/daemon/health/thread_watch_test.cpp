// SPDX-License-Identifier: Apache-2.0
// Which threads are starved and which are stuck: by lines as proc(5) has them, and by the scheduler itself.
#include "daemon/realtime/thread_watch.h"

#include <gtest/gtest.h>
#include <sched.h>
#include <unistd.h>

#include <atomic>
#include <chrono>
#include <thread>
#include <vector>

namespace ifog {
namespace {

// Of a real thread; fields 14 and 15 are 21 and 34.
constexpr const char* kLine =
    "4242 (if og) R) S 1 4242 4242 0 -1 4194368 120 0 1 0 21 34 0 0 -51 0 3 0 512 1000000 200 "
    "18446744073709551615 1 1 0 0 0 0 0 4096 0 0 0 0 -1 1 50 1 0 0 0\n";

TEST(ThreadWatch, ReadsStateAndTimeBehindAnyName) {
  const ThreadTime time = parse_thread_stat(kLine);
  EXPECT_EQ(time.state, 'S');
  EXPECT_EQ(time.ticks, 55U);
  EXPECT_EQ(parse_thread_stat("").state, '?');
  EXPECT_EQ(parse_thread_stat("4242 (nose) R 1 2").state, '?');
}

TEST(ThreadWatch, StarvedIsReadyBothTimesWithoutAProcessorBetween) {
  EXPECT_TRUE(starved_between({'R', 7}, {'R', 7}));
  EXPECT_FALSE(starved_between({'R', 7}, {'R', 8}));  // works without an end
  EXPECT_FALSE(starved_between({'S', 7}, {'S', 7}));  // waits, for ever perhaps
  EXPECT_FALSE(starved_between({'D', 7}, {'D', 7}));
  EXPECT_FALSE(starved_between({'T', 7}, {'T', 7}));
  EXPECT_FALSE(starved_between({'S', 7}, {'R', 7}));
  EXPECT_FALSE(starved_between({'?', 0}, {'?', 0}));
}

bool on_processor(int cpu, int priority) {
  cpu_set_t set;
  CPU_ZERO(&set);
  CPU_SET(static_cast<std::size_t>(cpu), &set);
  sched_param wanted{};
  wanted.sched_priority = priority;
  return sched_setaffinity(0, sizeof set, &set) == 0 && sched_setscheduler(0, SCHED_FIFO, &wanted) == 0;
}

// Two processors that this process may use; fewer where there are fewer.
std::vector<int> two_processors() {
  cpu_set_t allowed;
  CPU_ZERO(&allowed);
  sched_getaffinity(0, sizeof allowed, &allowed);
  std::vector<int> out;
  for (int cpu = 0; cpu < CPU_SETSIZE && out.size() < 2; ++cpu)
    if (CPU_ISSET(static_cast<std::size_t>(cpu), &allowed)) out.push_back(cpu);
  return out;
}

// A thread of a higher priority works on the only processor of the one that is watched.
TEST(ThreadWatch, AThreadBehindOneOfAHigherPriorityIsStarvedUntilThatEnds) {
  const std::vector<int> processors = two_processors();
  if (processors.size() < 2) GTEST_SKIP() << "one processor: whoever asks would be starved as well";
  ThreadWatch watch;
  enum { refused = -1, begins, waits, works, over };
  std::atomic<int> state{begins};
  std::atomic<bool> go{false}, came{false};
  std::thread watched([&] {
    watch.begin();
    state = on_processor(processors[1], 1) ? waits : refused;
    state.notify_all();
    go.wait(false);
    came = true;
  });
  state.wait(begins);
  if (state == refused) {
    go = true;
    go.notify_one();
    watched.join();
    GTEST_SKIP() << "SCHED_FIFO refused (needs CAP_SYS_NICE)";
  }
  std::thread load([&] {
    on_processor(processors[1], 2);
    state = works;
    state.notify_all();
    while (state != over) continue;
  });
  // Whoever asks keeps to the other one.
  cpu_set_t other;
  CPU_ZERO(&other);
  CPU_SET(static_cast<std::size_t>(processors[0]), &other);
  std::thread asks([&] {
    ASSERT_EQ(sched_setaffinity(0, sizeof other, &other), 0);
    state.wait(waits);
    go = true;
    go.notify_one();
    (void)watch.starved();
    std::this_thread::sleep_for(std::chrono::milliseconds(50));  // ticks are of 10 ms
    EXPECT_TRUE(watch.starved());
    EXPECT_FALSE(came);
    state = over;
  });
  asks.join();
  load.join();
  watched.join();
  EXPECT_TRUE(came);
  EXPECT_FALSE(watch.starved());
}

}  // namespace
}  // namespace ifog
