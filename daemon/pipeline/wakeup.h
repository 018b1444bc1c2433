// Wakes the one consumer of a ring, with a system call only when it sleeps.
//
// The consumer announces its sleep, looks at the ring once more and only then sleeps; the producer commits
// and then looks for the announcement. The two full fences make it impossible that the consumer misses the
// slot and the producer misses the announcement.
#pragma once

#include <atomic>
#include <cstdint>

namespace ifog {

class Wakeup {
 public:
  // Producer, after what the consumer waits for has been made visible.
  void notify() noexcept {
    std::atomic_thread_fence(std::memory_order_seq_cst);
    if (asleep_.load(std::memory_order_relaxed) == 0) return;
    wake();
  }
  // Consumer: sleeps until notify() unless ready() holds. May return early for no reason.
  template <typename Ready>
  void wait(Ready&& ready) noexcept {
    asleep_.store(1, std::memory_order_relaxed);
    std::atomic_thread_fence(std::memory_order_seq_cst);
    if (!ready()) sleep();
    asleep_.store(0, std::memory_order_relaxed);
  }

 private:
  void wake() noexcept;
  void sleep() noexcept;
  alignas(64) std::atomic<std::uint32_t> asleep_{0};
};

}  // namespace ifog
