// SPDX-License-Identifier: Apache-2.0
// Throughput of the daemon's ring compared with Boost.Lockfree's spsc_queue and moodycamel's
// ReaderWriterQueue: increments between two threads, interleaved runs, medians.  usage: ring_bench [MILLIONS
// [RUNS]]
#include <readerwriterqueue/readerwriterqueue.h>
#include <algorithm>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdio>
#include <cstdlib>
#include <ctime>
#include <string>
#include <thread>
#include <vector>

#include "daemon/pipeline/ring.h"
#include "filters/chain/reading.h"

namespace {

constexpr std::size_t kSlots = 1024;

struct Small {
  std::uint64_t sequence = 0;
  double values[7]{};
};

// Interface to a queue: put() and take() return false if it is full or empty.
template <typename T>
struct Ours {
  ifog::Ring<T> ring{kSlots};
  bool put(std::uint64_t n) {
    T* const slot = ring.claim();
    if (slot == nullptr) return false;
    slot->sequence = n;
    ring.commit();
    return true;
  }
  bool take(std::uint64_t& n) {
    const T* const slot = ring.front();
    if (slot == nullptr) return false;
    n = slot->sequence;
    ring.pop();
    return true;
  }
};

template <typename T>
struct Moodycamel {
  moodycamel::ReaderWriterQueue<T> queue{kSlots};
  T item;
  bool put(std::uint64_t n) {
    item.sequence = n;
    return queue.try_enqueue(item);
  }
  bool take(std::uint64_t& n) {
    const T* const front = queue.peek();  // its in-place interface
    if (front == nullptr) return false;
    n = front->sequence;
    queue.pop();
    return true;
  }
};

template <typename T>
struct Boost {
  boost::lockfree::spsc_queue<T, boost::lockfree::capacity<kSlots>> queue;
  T item;
  bool put(std::uint64_t n) {
    item.sequence = n;
    return queue.push(item);
  }
  bool take(std::uint64_t& n) {
    if (queue.read_available() == 0) return false;
    n = queue.front().sequence;
    queue.pop();
    return true;
  }
};

template <typename Queue>
double millions_per_second(std::uint64_t count) {
  auto queue = std::make_unique<Queue>();
  timespec start{}, end{};
  clock_gettime(CLOCK_MONOTONIC, &start);
  std::thread producer([&] {
    for (std::uint64_t n = 0; n < count;)
      if (queue->put(n))
        ++n;
      else
        std::this_thread::yield();
  });
  for (std::uint64_t expected = 0, n = 0; expected < count;) {
    if (!queue->take(n)) {
      std::this_thread::yield();
      continue;
    }
    if (n != expected++) std::abort();
  }
  producer.join();
  clock_gettime(CLOCK_MONOTONIC, &end);
  const double seconds = static_cast<double>(end.tv_sec - start.tv_sec) +
                         1e-9 * static_cast<double>(end.tv_nsec - start.tv_nsec);
  return 1e-6 * static_cast<double>(count) / seconds;
}

double median(std::vector<double> values) {
  std::sort(values.begin(), values.end());
  return values[values.size() / 2];
}

template <typename T>
void compare(const char* what, std::uint64_t count, int runs) {
  std::vector<double> ours, moodycamel, boost;
  for (int run = 0; run < runs; ++run) {
    ours.push_back(millions_per_second<Ours<T>>(count));
    moodycamel.push_back(millions_per_second<Moodycamel<T>>(count));
    boost.push_back(millions_per_second<Boost<T>>(count));
  }
  const double best = std::max(median(moodycamel), median(boost));
  std::printf("%-22s %8.2f %12.2f %8.2f %10.2f\n", what, median(ours), median(moodycamel), median(boost),
              median(ours) / best);
}

}  // namespace

int main(int argc, char** argv) {
  const double millions = argc > 1 ? std::atof(argv[1]) : 2.0;
  const int runs = argc > 2 ? std::atoi(argv[2]) : 9;
  const auto count = static_cast<std::uint64_t>(millions * 1e6);
  std::printf("million items a second, median of %d interleaved runs of %.1f million, %zu slots\n", runs,
              millions, kSlots);
  std::printf("%-22s %8s %12s %8s %10s\n", "item", "ours", "moodycamel", "boost", "ours/best");
  compare<Small>("64 bytes", count, runs);
  compare<ifog::Increment>(("increment, " + std::to_string(sizeof(ifog::Increment)) + " bytes").c_str(),
                           count, runs);
  return 0;
}
