// SPDX-License-Identifier: Apache-2.0
// Counters of the kernel for this process's threads.
#pragma once

#include <cstdint>
#include <string>

namespace ifog {

struct ThreadCosts {
  std::uint64_t faults = 0;     // page faults
  std::uint64_t slept = 0;      // voluntary context switches
  std::uint64_t preempted = 0;  // involuntary context switches

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

// Sum over all threads of this name, while they run.
ThreadCosts costs_of_threads(const std::string& name);

}  // namespace ifog
