// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/increment_queue.h"

#include <chrono>
#include <thread>

namespace ifog {
namespace {

// Interval between checks for space, of a producer that may wait; short compared with a ring of increments.
constexpr auto kPause = std::chrono::microseconds(50);

}  // namespace

Increment& IncrementQueue::next() noexcept {
  if (when_full_ == WhenFull::wait) {
    while ((slot_ = ring_.claim()) == nullptr) {
      wakeup_.notify();
      std::this_thread::sleep_for(kPause);
    }
    return *slot_;
  }
  // While an increment waits outside, none may enter directly, to keep the order.
  slot_ = has_waiting_ && !place_waiting() ? nullptr : ring_.claim();
  return slot_ != nullptr ? *slot_ : spare_;
}

void IncrementQueue::push() noexcept {
  if (slot_ != nullptr) {
    ring_.commit();
  } else if (has_waiting_) {
    merge(waiting_, spare_);
    merged_.add(1);
  } else {
    waiting_ = spare_;
    has_waiting_ = true;
    overflows_.add(1);
  }
}

bool IncrementQueue::place_waiting() noexcept {
  Increment* const room = ring_.claim();
  if (room == nullptr) return false;
  *room = waiting_;
  ring_.commit();
  has_waiting_ = false;
  return true;
}

void IncrementQueue::flush() noexcept {
  if (has_waiting_) place_waiting();
  wakeup_.notify();
}

bool IncrementQueue::flush_or_borrow(std::size_t most) noexcept {
  if (has_waiting_) place_waiting();
  if (ring_.size() <= most && wakeup_.borrow()) return true;
  wakeup_.notify();
  return false;
}

void IncrementQueue::close() noexcept {
  while (has_waiting_ && !place_waiting()) {
    wakeup_.notify();
    std::this_thread::sleep_for(kPause);
  }
  closed_.store(true, std::memory_order_release);
  wakeup_.notify();
}

void IncrementQueue::wait() noexcept {
  wakeup_.wait([this] {
    return ring_.size() > 0 || closed_.load(std::memory_order_acquire) ||
           nudged_.exchange(false, std::memory_order_acq_rel);
  });
  nudged_.exchange(false, std::memory_order_acq_rel);
}

void IncrementQueue::notify() noexcept {
  nudged_.store(true, std::memory_order_release);
  wakeup_.notify();
}

}  // namespace ifog
