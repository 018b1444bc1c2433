// SPDX-License-Identifier: Apache-2.0
// Values of environment channels from outside the sensor's frames. Written by the source's thread, read by
// the sensor's reader thread at every sample.
#pragma once

#include <atomic>
#include <cstdint>
#include <limits>
#include <memory>

#include "drivers/flight/entry.h"

namespace ifog {

// Reason why a channel has no new value, as plain data for any thread; ChannelWatch makes the text.
struct ChannelFault {
  enum class Kind : std::uint8_t {
    silent,        // nothing was received, or nothing more
    unreadable,    // file: opening or reading failed with `error`
    no_file,       // file: a folder, FIFO or device
    empty,         // file: empty
    no_number,     // file: not a single number
    no_message,    // lcm: a message of a type without values
    no_field,      // lcm: the message does not have the field
    late,          // lcm: older than the last value
    clock_behind,  // lcm: the sender's clock is behind by `error` seconds
    impossible,    // the value is outside its possible range
  };
  Kind kind = Kind::silent;
  int error = 0;  // errno; clock_behind: s

  bool operator==(const ChannelFault&) const = default;
};

class ChannelTable {
 public:
  explicit ChannelTable(int channels)
      : entries_(std::make_unique<Entry[]>(static_cast<std::size_t>(channels))) {}

  // One writer per channel.
  void set(int channel, double value, std::int64_t time_ns) noexcept {
    Entry& entry = entries_[static_cast<std::size_t>(channel)];
    entry.value.store(value, std::memory_order_relaxed);
    entry.time_ns.store(time_ns, std::memory_order_release);
    entry.fault.store({}, std::memory_order_relaxed);
  }
  // The reading is invalid: the last value is held and ages.
  void refuse(int channel, ChannelFault fault) noexcept {
    miss(channel, fault);
    refused_.fetch_add(1, std::memory_order_relaxed);
  }
  // Nothing was received, for this reason, which is kept until the next one.
  void miss(int channel, ChannelFault fault) noexcept {
    entries_[static_cast<std::size_t>(channel)].fault.store(fault, std::memory_order_relaxed);
  }
  [[nodiscard]] ChannelFault fault(int channel) const noexcept {
    return entries_[static_cast<std::size_t>(channel)].fault.load(std::memory_order_relaxed);
  }
  [[nodiscard]] std::uint64_t refused() const noexcept { return refused_.load(std::memory_order_relaxed); }
  // Counts messages of these channels' source that were lost before they could be read.
  void lose(std::uint64_t messages) noexcept { drops_.fetch_add(messages, std::memory_order_relaxed); }
  [[nodiscard]] std::uint64_t drops() const noexcept { return drops_.load(std::memory_order_relaxed); }

  // The value is at least as new as its time: an update between the two loads affects only the value.
  [[nodiscard]] ChannelValue latest(int channel) const noexcept {
    const Entry& entry = entries_[static_cast<std::size_t>(channel)];
    ChannelValue out;
    out.time_ns = entry.time_ns.load(std::memory_order_acquire);
    out.value = entry.value.load(std::memory_order_relaxed);
    return out;
  }

 private:
  struct Entry {
    std::atomic<double> value{std::numeric_limits<double>::quiet_NaN()};
    std::atomic<std::int64_t> time_ns{0};
    std::atomic<ChannelFault> fault{};  // of the last reading; `silent` after a valid value
  };
  std::unique_ptr<Entry[]> entries_;
  std::atomic<std::uint64_t> refused_{0}, drops_{0};
  static_assert(std::atomic<ChannelFault>::is_always_lock_free);
};

}  // namespace ifog
