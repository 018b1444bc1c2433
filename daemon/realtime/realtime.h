// SPDX-License-Identifier: Apache-2.0
// What a real-time thread needs before its loop: memory that cannot be paged out, its scheduling class, its
// processors. Nothing here is required to run; what could not be had comes back as a line for the log.
#pragma once

#include <string>
#include <vector>

namespace ifog {

struct ThreadPlan {
  std::string name;       // as shown by ps and top, at most 15 characters
  int priority = 0;       // SCHED_FIFO 1 … 99; 0: the ordinary scheduler
  std::vector<int> cpus;  // empty: any
};

// Applies to the calling thread. Returns "" or what could not be had and why.
std::string apply_to_this_thread(const ThreadPlan& plan);

// Touches the calling thread's stack, so that its pages are there before the loop.
void prefault_stack() noexcept;

// mlockall of all that is and will be mapped; threads that start later get small stacks. Returns "" or why
// not.
std::string lock_memory();

}  // namespace ifog
