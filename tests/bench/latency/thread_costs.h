// SPDX-License-Identifier: Apache-2.0
// What the kernel has counted of this process's threads.
#pragma once

#include <cstdint>
#include <string>

namespace ifog {

struct ThreadCosts {
  std::uint64_t faults = 0;     // pages that were not there
  std::uint64_t slept = 0;      // times that one went to sleep
  std::uint64_t preempted = 0;  // times that one was put off its processor

  ThreadCosts& operator+=(const ThreadCosts& other) {
    faults += other.faults;
    slept += other.slept;
    preempted += other.preempted;
    return *this;
  }
  ThreadCosts operator-(const ThreadCosts& other) const {
    return {faults - other.faults, slept - other.slept, preempted - other.preempted};
  }
};

// Of all that have this name, while they run.
ThreadCosts costs_of_threads(const std::string& name);

}  // namespace ifog
