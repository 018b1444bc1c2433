// SPDX-License-Identifier: Apache-2.0
// Ring buffer for a single producer and a single consumer; wait-free, no allocation after construction.
//
// Slots are filled and read in place (claim/commit, front/pop), since increments are several hundred bytes.
// Each side caches the other's index on its own cache line. It reads the shared one only if the ring seems
// full or empty, which reduces cache traffic. tests/bench/ring compares it with Boost.Lockfree and
// moodycamel's ReaderWriterQueue.
//
// If the ring is full claim() returns null, and the caller decides (IncrementQueue merges).
#pragma once

#include <atomic>
#include <bit>
#include <cstddef>
#include <memory>

namespace ifog {

template <typename T>
class Ring {
 public:
  // capacity: rounded up to a power of two.
  explicit Ring(std::size_t capacity)
      : mask_(std::bit_ceil(capacity) - 1), slots_(std::make_unique<T[]>(mask_ + 1)) {}

  // Producer: next slot to fill, null if full; the same slot until commit().
  [[nodiscard]] T* claim() noexcept {
    const std::size_t head = head_.load(std::memory_order_relaxed);
    if (head - tail_seen_ > mask_) {
      tail_seen_ = tail_.load(std::memory_order_acquire);
      if (head - tail_seen_ > mask_) return nullptr;
    }
    return &slots_[head & mask_];
  }
  void commit() noexcept {
    head_.store(head_.load(std::memory_order_relaxed) + 1, std::memory_order_release);
  }

  // Consumer: oldest slot, null if empty; valid until pop().
  [[nodiscard]] T* front() noexcept {
    const std::size_t tail = tail_.load(std::memory_order_relaxed);
    if (tail == head_seen_) {
      head_seen_ = head_.load(std::memory_order_acquire);
      if (tail == head_seen_) return nullptr;
    }
    return &slots_[tail & mask_];
  }
  void pop() noexcept { tail_.store(tail_.load(std::memory_order_relaxed) + 1, std::memory_order_release); }

  // Any thread: number of committed slots, with or without concurrent changes. The consumer never sees fewer,
  // the producer never more, than there are on return.
  [[nodiscard]] std::size_t size() const noexcept {
    const std::size_t tail = tail_.load(std::memory_order_acquire);
    return head_.load(std::memory_order_acquire) - tail;
  }

 private:
  // Not std::hardware_destructive_interference_size, which depends on compiler flags.
  static constexpr std::size_t kLine = 64;
  const std::size_t mask_;
  const std::unique_ptr<T[]> slots_;
  alignas(kLine) std::atomic<std::size_t> head_{0};  // written by the producer
  std::size_t tail_seen_ = 0;                        // producer's copy of tail_
  alignas(kLine) std::atomic<std::size_t> tail_{0};  // written by the consumer
  std::size_t head_seen_ = 0;                        // consumer's copy of head_
};

}  // namespace ifog
