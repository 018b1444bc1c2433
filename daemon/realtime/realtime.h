// SPDX-License-Identifier: Apache-2.0
// Preparation of real-time threads: locked memory, scheduling class, processors. Nothing is required;
// failures are returned as text for the log.
#pragma once

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

}  // namespace ifog
