// SPDX-License-Identifier: Apache-2.0
// The way from the reader thread to the filter thread: a ring that loses no angle.
//
// Overflow policy: merge. When the ring is full, further increments are added up in a single one outside of it;
// it goes in as soon as there is room. Δθ, time and count of every sample arrive, only their resolution in
// time suffers; each merge is counted. A source that keeps its bytes until they are read (a file) waits for
// room instead.
#pragma once

#include <atomic>
#include <cstddef>

#include "daemon/pipeline/ring.h"
#include "daemon/pipeline/wakeup.h"
#include "drivers/transport/counter.h"
#include "filters/chain/reading.h"

namespace ifog {

class IncrementQueue {
 public:
  enum class WhenFull { merge, wait };

  IncrementQueue(std::size_t capacity, WhenFull when_full) : ring_(capacity), when_full_(when_full) {}

  // Producer. Where the next increment is to be written; always succeeds.
  [[nodiscard]] Increment& next() noexcept;
  void push() noexcept;  // what next() gave is complete
  // After a delivery: wakes the consumer once for all of it, and moves a merged increment into room that has
  // come.
  void flush() noexcept;
  // In place of flush(), for a producer that can do the consumer's work. True: the consumer sleeps, is left
  // asleep, and the caller is the consumer until give_back(). False, the consumer has been woken: it was
  // awake, or more than `most` increments wait.
  [[nodiscard]] bool flush_or_borrow(std::size_t most) noexcept;
  void give_back() noexcept { wakeup_.give_back(ring_.size() > 0); }
  [[nodiscard]] bool waits_when_full() const noexcept { return when_full_ == WhenFull::wait; }
  // Something waits outside the full ring: without a further delivery nobody but the next flush moves it in.
  [[nodiscard]] bool has_waiting() const noexcept { return has_waiting_; }
  // No more will come. Waits until the last increment is in the ring.
  void close() noexcept;

  // Consumer.
  [[nodiscard]] Increment* front() noexcept { return ring_.front(); }
  void pop() noexcept { ring_.pop(); }
  // Sleeps until there is something, or notify().
  void wait() noexcept;
  // True once close() has been called and the queue is empty.
  [[nodiscard]] bool finished() noexcept {
    return closed_.load(std::memory_order_acquire) && ring_.front() == nullptr;
  }

  // Any thread: lets a sleeping consumer look around.
  void notify() noexcept;

  [[nodiscard]] std::uint64_t overflows() const noexcept {
    return overflows_.value();
  }  // times the ring became full
  [[nodiscard]] std::uint64_t merged() const noexcept {
    return merged_.value();
  }  // samples that went into another

 private:
  bool place_waiting() noexcept;

  Ring<Increment> ring_;
  const WhenFull when_full_;
  Increment* slot_ = nullptr;  // in the ring, or null: spare_ is being filled
  Increment spare_;
  Increment waiting_;  // merged, outside the ring
  bool has_waiting_ = false;
  Wakeup wakeup_;
  std::atomic<bool> closed_{false};
  std::atomic<bool> nudged_{false};
  Counter overflows_, merged_;
};

}  // namespace ifog
