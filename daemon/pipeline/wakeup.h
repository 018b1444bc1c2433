// SPDX-License-Identifier: Apache-2.0
// Wakes the consumer of a ring, with a system call only if it sleeps; or lends its place to the producer
// while it sleeps, so that waking is unnecessary.
//
// The consumer announces its sleep, checks the ring again and then sleeps; the producer commits and then
// checks the announcement. All accesses to the announcement are read-modify-write and form one chain: either
// the producer sees the announcement, or the consumer sees the slot. So no fence is needed (ThreadSanitizer
// does not support them).
//
// One word determines who is the consumer: the consumer itself if `awake`, the producer if `lent` (or
// `lent_called`: the consumer is wanted after the return), nobody if `asleep`.
#pragma once

#include <atomic>
#include <cstdint>

namespace ifog {

class Wakeup {
 public:
  // Any thread, after it has published what the consumer waits for.
  void notify() noexcept;

  // Producer, likewise. True: the consumer stays asleep, and the caller is the consumer until give_back().
  // False: it is awake and will see the data.
  bool borrow() noexcept;
  // wake: data are left for the consumer.
  void give_back(bool wake) noexcept;

  // Consumer: sleeps until notify() unless ready() is true. ready() may be called while the place is lent, so
  // it must use atomics only.
  template <typename Ready>
  void wait(Ready&& ready) noexcept {
    state_.exchange(kAsleep, std::memory_order_acq_rel);
    if (ready()) notify();  // wakes itself, or asks for its place
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
