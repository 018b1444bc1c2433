// SPDX-License-Identifier: Apache-2.0
// Wakes the one consumer of a ring, with a system call only when it sleeps; or lends the producer the
// consumer's place while it sleeps, so that nobody need be woken at all.
//
// The consumer announces its sleep, looks at the ring once more and only then sleeps; the producer commits
// and then looks for the announcement. Every access to the announcement is a read-modify-write, so they form
// one chain: either the producer's comes later and finds the announcement, or the consumer's comes later and,
// by reading from it, sees the slot. No fence is needed, which ThreadSanitizer would not understand.
//
// Who may act as the consumer follows from one word: the consumer while it is `awake`, the producer while it
// is `lent` (or `lent_called`: somebody wants the consumer as soon as it is given back), nobody while it is
// `asleep`.
#pragma once

#include <atomic>
#include <cstdint>

namespace ifog {

class Wakeup {
 public:
  // Any thread, after what the consumer waits for has been made visible.
  void notify() noexcept;

  // Producer, likewise. True: the consumer sleeps and stays asleep, and the caller is the consumer until
  // give_back(). False: it is awake and will see what has been made visible.
  bool borrow() noexcept;
  // wake: something is left for the consumer.
  void give_back(bool wake) noexcept;

  // Consumer: sleeps until notify() unless ready() holds. ready() may be called while the place is lent: it
  // looks at atomics only.
  template <typename Ready>
  void wait(Ready&& ready) noexcept {
    state_.exchange(kAsleep, std::memory_order_acq_rel);
    if (ready()) notify();  // wakes itself, or asks for its place back
    sleep();
  }

 private:
  static constexpr std::uint32_t kAwake = 0, kAsleep = 1, kLent = 2, kLentCalled = 3;
  bool change(std::uint32_t from, std::uint32_t to) noexcept;
  void wake() noexcept;
  void sleep() noexcept;  // until awake
  alignas(64) std::atomic<std::uint32_t> state_{kAwake};
};

}  // namespace ifog
