// SPDX-License-Identifier: Apache-2.0
// Preparation of real-time threads: locked memory, scheduling class, processors. Nothing is required;
// failures are returned as text for the log.
#pragma once

#include <atomic>
#include <cstdint>
#include <string>
#include <vector>

namespace ifog {

struct ThreadPlan {
  std::string name;       // for ps and top, at most 15 characters
  int priority = 0;       // SCHED_FIFO 1 … 99; 0: ordinary scheduler
  std::vector<int> cpus;  // empty: any
};

// Applies to the calling thread. Returns "" or what failed and why.
std::string apply_to_this_thread(const ThreadPlan& plan);

// Touches the calling thread's stack, so that its pages are resident before the loop.
void prefault_stack() noexcept;

// mlockall for present and future mappings; later threads get small stacks. Returns "" or the reason of
// failure.
std::string lock_memory();

// Reason why a thread makes no progress: starved if it is ready but gets no processor (something has higher
// priority); stuck if it waits or does not finish.
class ThreadWatch {
 public:
  // For the watched thread.
  void begin() noexcept;
  // For one other thread: true if it was starved since the last call, ready both times without processor time
  // between.
  [[nodiscard]] bool starved();

 private:
  std::atomic<int> thread_{0};
  char state_ = '?';         // R: running or ready
  std::uint64_t ticks_ = 0;  // processor time, including the kernel
};

}  // namespace ifog
