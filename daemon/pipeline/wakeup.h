// Wakes the one consumer of a ring, with a system call only when it sleeps.
//
// The consumer announces its sleep, looks at the ring once more and only then sleeps; the producer commits
// and then looks for the announcement. Every access to the announcement is a read-modify-write, so they form
// one chain: either the producer's comes later and finds the announcement, or the consumer's comes later and,
// by reading from it, sees the slot. No fence is needed, which ThreadSanitizer would not understand.
#pragma once

#include <atomic>
#include <cstdint>

namespace ifog {

class Wakeup {
 public:
  // Producer, after what the consumer waits for has been made visible.
  void notify() noexcept {
    if (asleep_.fetch_or(0, std::memory_order_acq_rel) != 0) wake();
  }
  // Consumer: sleeps until notify() unless ready() holds. May return early for no reason.
  template <typename Ready>
  void wait(Ready&& ready) noexcept {
    asleep_.exchange(1, std::memory_order_acq_rel);
    if (!ready()) sleep();
    asleep_.exchange(0, std::memory_order_acq_rel);
  }

 private:
  void wake() noexcept;
  void sleep() noexcept;
  alignas(64) std::atomic<std::uint32_t> asleep_{0};
};

}  // namespace ifog
