// SPDX-License-Identifier: Apache-2.0
#include <sched.h>
#include <unistd.h>

#include "daemon/housekeeping/status_report.h"
#include "daemon/pipeline/processor_share.h"
#include "daemon/realtime/realtime.h"
#include "tests/unit/test.h"

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

// Which threads are starved, by the scheduler itself.

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
    pthread_setname_np(pthread_self(), "if og) S");  // as a field of proc(5)
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

// Read once a second, of a sensor slower and quicker than that.
TEST(CountedRate, IsThatOfTheSensorHoweverSlowItIs) {
  for (const double rate_hz : {0.02, 0.1, 0.37, 0.9, 1.0, 3.3, 50.0, 1000.0}) {
    CountedRate rate;
    double shown_hz = 0.0;
    const auto seconds = static_cast<int>(std::ceil(40.0 / rate_hz)) + 20;
    for (int s = 1; s <= seconds; ++s) {
      shown_hz = rate.of(static_cast<std::int64_t>(rate_hz * s + 0.5), 1.0, rate_hz);
      // A reading is a second: of ten samples that came, one of ten periods.
      if (s > 25.0 / rate_hz) {
        EXPECT_NEAR(shown_hz, rate_hz, 0.12 * rate_hz) << rate_hz << ", " << s;
      }
    }
    const auto last = static_cast<std::int64_t>(rate_hz * seconds + 0.5);
    for (int s = 0; s < 4.0 / rate_hz + 4.0; ++s) shown_hz = rate.of(last, 1.0, rate_hz);
    EXPECT_EQ(shown_hz, 0.0) << rate_hz << " Hz, silent";
  }
}

}  // namespace
}  // namespace ifog
