// SPDX-License-Identifier: Apache-2.0
// Ring from the reader to the filter thread that loses no angle.
//
// On overflow, further increments are merged into one outside the ring, which enters as soon as there is
// space. Δθ, time and count of all samples are kept, only the time resolution suffers; each merge is counted.
// A source that buffers until it is read (a file) waits instead.
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

  // Producer: slot for the next increment; always succeeds.
  [[nodiscard]] Increment& next() noexcept;
  void push() noexcept;  // the slot of next() is complete
  // After a delivery: wakes the consumer once, and moves a merged increment into free space.
  void flush() noexcept;
  // Instead of flush(), if the producer can do the consumer's work. True: the consumer sleeps, and the caller
  // is the consumer until give_back(). False: the consumer was awake or has been woken, e.g. because more
  // than `most` increments wait.
  [[nodiscard]] bool flush_or_borrow(std::size_t most) noexcept;
  void give_back() noexcept { wakeup_.give_back(ring_.size() > 0); }
  [[nodiscard]] bool waits_when_full() const noexcept { return when_full_ == WhenFull::wait; }
  // An increment waits outside the full ring; only the next flush moves it in.
  [[nodiscard]] bool has_waiting() const noexcept { return has_waiting_; }
  // End of data. Waits until the last increment is in the ring.
  void close() noexcept;

  // Consumer.
  [[nodiscard]] Increment* front() noexcept { return ring_.front(); }
  void pop() noexcept { ring_.pop(); }
  // Sleeps until there is data, or notify().
  void wait() noexcept;
  // True after close() if the queue is empty.
  [[nodiscard]] bool finished() noexcept {
    return closed_.load(std::memory_order_acquire) && ring_.front() == nullptr;
  }

  // Any thread: wakes a sleeping consumer.
  void notify() noexcept;

  // Number of overflows, and of samples merged into others.
  [[nodiscard]] std::uint64_t overflows() const noexcept { return overflows_.value(); }
  [[nodiscard]] std::uint64_t merged() const noexcept { return merged_.value(); }

 private:
  bool place_waiting() noexcept;

  Ring<Increment> ring_;
  const WhenFull when_full_;
  Increment* slot_ = nullptr;  // in the ring, or null: spare_ is used
  Increment spare_;
  Increment waiting_;  // merged, outside the ring
  bool has_waiting_ = false;
  Wakeup wakeup_;
  std::atomic<bool> closed_{false};
  std::atomic<bool> nudged_{false};
  Counter overflows_, merged_;
};

}  // namespace ifog
