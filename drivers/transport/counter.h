// SPDX-License-Identifier: Apache-2.0
// A counter with one writer and any number of readers. Relaxed: it says how much happened and orders nothing,
// so a reader may see one counter ahead of another that was raised before it, by what is under way.
#pragma once

#include <atomic>
#include <cstdint>

namespace ifog {

class Counter {
 public:
  // One writer: a plain load and store do, no locked instruction.
  void add(std::uint64_t n) noexcept { set(value() + n); }
  void set(std::uint64_t n) noexcept { count_.store(n, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t value() const noexcept { return count_.load(std::memory_order_relaxed); }

 private:
  std::atomic<std::uint64_t> count_{0};
};

}  // namespace ifog
