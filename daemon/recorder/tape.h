// SPDX-License-Identifier: Apache-2.0
// From the reader thread to the recorder thread: entries of a flight recording in a bounded queue of bytes
// that is allocated once. The reader only copies; where there is no room the delivery is not recorded, which
// is counted here and stated in the recording itself.
#pragma once

#include <array>
#include <atomic>
#include <boost/lockfree/spsc_queue.hpp>
#include <cstdint>
#include <cstring>
#include <memory>
#include <optional>
#include <span>
#include <vector>

#include "drivers/flight/entry.h"
#include "drivers/transport/counter.h"
#include "drivers/transport/transport.h"
#include "filters/chain/reading.h"

namespace ifog {

// Deliveries and bytes (payload) received, and those of them that found no room. Any thread may read them.
struct TapeCounters {
  Counter deliveries, bytes, lost_deliveries, lost_bytes;
};

// Every page of it is there from the start: where memory is not locked the reader thread would otherwise wait
// for one at every hundredth delivery, until the tape has gone round once.
template <typename T>
struct TouchedMemory : std::allocator<T> {
  template <typename U>
  struct rebind {
    using other = TouchedMemory<U>;
  };
  T* allocate(std::size_t n) {
    T* const out = std::allocator<T>::allocate(n);
    std::memset(out, 0, n * sizeof(T));
    return out;
  }
};

class Tape {
 public:
  // Most that one delivery takes, however many CAN frames or channels it brings: a tape is no smaller.
  static constexpr std::size_t kLeastBytes = 1U << 18U;
  explicit Tape(std::size_t bytes);

  // Reader thread; allocates nothing, waits for nothing. `read_ns` is when it was read, for what arrived at no
  // known time; `channels` and `wall_shift_ns` are what it was decoded with, `merged` the samples of the run
  // that have gone into others up to and with it (IncrementQueue::merged()): recorded where they have
  // changed.
  void put(const Delivery& delivery, std::int64_t read_ns, std::span<const ChannelValue> channels,
           std::int64_t wall_shift_ns, std::uint64_t merged = 0) noexcept;

  // Reader thread: what is put from now on was filtered with the settings of this number, not 0.
  void note_settings(std::uint32_t number) noexcept { settings_due_ = number; }
  // Reader thread, for a source that can wait: there is no room for this delivery, and the recorder is at
  // work and will make some.
  [[nodiscard]] bool worth_waiting(const Delivery& delivery) const noexcept;

  // Recorder thread: the oldest entry; false: there is none, or it is still being written. A `settings` entry
  // has no payload, its number is the head's length.
  bool take(FlightEntryHead& head, std::vector<std::uint8_t>& payload);
  // Recorder thread: the last entry read is the first of a delivery.
  [[nodiscard]] bool begins_delivery() const noexcept { return begins_delivery_; }
  // Recorder thread.
  [[nodiscard]] bool is_half_full() const noexcept { return queue_.read_available() > bytes_ / 2; }
  // Recorder thread: that it is at work; not when the disk takes nothing.
  void attend(bool at_work) noexcept;

  [[nodiscard]] const TapeCounters& counters() const noexcept { return counters_; }

 private:
  static std::size_t room_for(const Delivery& delivery) noexcept;
  void push(const FlightEntryHead& head, const void* payload, std::size_t length) noexcept;
  void push_state(std::span<const ChannelValue> channels, std::int64_t wall_shift_ns) noexcept;
  void push_frame(const ifog_can_frame& frame, std::uint8_t flags, std::int64_t read_ns) noexcept;

  std::size_t bytes_;
  boost::lockfree::spsc_queue<std::uint8_t, boost::lockfree::allocator<TouchedMemory<std::uint8_t>>> queue_;
  // Reader thread.
  std::array<ChannelValue, kMaxChannels> recorded_{};  // of each channel, the last
  std::int64_t wall_shift_ns_ = 0;
  std::uint64_t merged_ = 0;
  std::uint64_t untold_deliveries_ = 0, untold_bytes_ = 0;  // lost since the last `lost` entry
  bool reopened_ = false;                                   // with a delivery that was lost
  std::uint32_t settings_due_ = 0;
  TapeCounters counters_;
  // Recorder thread: in lines of the cache of its own.
  alignas(64) std::atomic<std::int64_t> attended_ns_{0};  // monotonic; 0: not
  std::optional<FlightEntryHead> begun_;
  bool begins_delivery_ = false;
};

}  // namespace ifog
