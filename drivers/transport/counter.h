// SPDX-License-Identifier: Apache-2.0
// Counter with one writer and any number of readers. Relaxed memory order: a reader may see counters in
// another order than they were changed.
#pragma once

#include <atomic>
#include <cstdint>

namespace ifog {

class Counter {
 public:
  // One writer: load and store suffice, without a locked instruction.
  void add(std::uint64_t n) noexcept { set(value() + n); }
  void set(std::uint64_t n) noexcept { count_.store(n, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t value() const noexcept { return count_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> count_{0};
};

}  // namespace ifog
