// SPDX-License-Identifier: Apache-2.0
// Counts heap allocations of the whole program, on all threads: malloc itself is replaced, so that those of
// Eigen and of C libraries (glib in LCM) count, too. A program that links malloc_counter.cpp has it.
#pragma once

#include <cstdint>

namespace ifog::test {

// False under a sanitizer, which has its own allocator.
[[nodiscard]] bool allocations_can_be_counted();
void count_allocations(bool on);
// Counted so far, and the count back to zero.
[[nodiscard]] std::uint64_t take_allocations();

// Makes a few, counts them and throws them away: whether the counter counts, what a test rests on.
[[nodiscard]] bool allocation_counter_works();

}  // namespace ifog::test
