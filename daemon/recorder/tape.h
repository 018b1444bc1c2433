// SPDX-License-Identifier: Apache-2.0
// Entries of a flight recording from reader to recorder thread, in a bounded queue of bytes allocated once.
// The reader only copies; without space a delivery is not recorded, which is counted here and in the
// recording.
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

#include "drivers/flight/archive.h"
#include "drivers/flight/entry.h"
#include "drivers/transport/counter.h"
#include "drivers/transport/transport.h"
#include "filters/chain/reading.h"

namespace ifog {

// Deliveries and payload bytes received, and those without space. Readable by any thread.
struct TapeCounters {
  Counter deliveries, bytes, lost_deliveries, lost_bytes;
};

class Tape {
 public:
  // Largest size of one delivery, and smallest tape.
  static constexpr std::size_t kLeastBytes = 1U << 18U;
  explicit Tape(std::size_t bytes);

  // Reader thread; no allocation, no waiting. read_ns: time of the read, used if the arrival is unknown.
  // channels, wall_shift_ns: as used for decoding; merged: samples of the run merged so far
  // (IncrementQueue::merged()). These three are recorded when they change.
  void put(const Delivery& delivery, std::int64_t read_ns, std::span<const ChannelValue> channels,
           std::int64_t wall_shift_ns, std::uint64_t merged = 0) noexcept;

  // Reader thread: later entries were filtered with the settings of this number, not 0.
  void note_settings(std::uint32_t number) noexcept { settings_due_ = number; }
  // Reader thread, for a source that can wait: true if there is no space, and the working recorder will make
  // some.
  [[nodiscard]] bool worth_waiting(const Delivery& delivery) const noexcept;

  // Recorder thread: oldest entry; false: none, or still being written. A `settings` entry has no payload;
  // its number is in the head's length.
  bool take(FlightEntryHead& head, std::vector<std::uint8_t>& payload);
  // Recorder thread: the last entry is the first of a delivery.
  [[nodiscard]] bool begins_delivery() const noexcept { return begins_delivery_; }
  // For the recorder thread.
  [[nodiscard]] bool is_half_full() const noexcept { return queue_.read_available() > bytes_ / 2; }
  // Recorder thread: reports progress; not called if the disk accepts nothing.
  void attend(bool at_work) noexcept;

  [[nodiscard]] const TapeCounters& counters() const noexcept { return counters_; }

 private:
  static std::size_t room_for(const Delivery& delivery) noexcept;
  void push(const FlightEntryHead& head, const void* payload, std::size_t length) noexcept;
  void push_state(std::span<const ChannelValue> channels, std::int64_t wall_shift_ns) noexcept;
  void push_frame(const ifog_can_frame& frame, std::uint8_t flags, std::int64_t read_ns) noexcept;

  std::size_t bytes_;
  boost::lockfree::spsc_queue<std::uint8_t> queue_;
  // Reader thread.
  std::array<ChannelValue, kMaxChannels> recorded_{};  // last recorded value of each channel
  std::int64_t wall_shift_ns_ = 0;
  std::uint64_t merged_ = 0;
  FlightLoss unreported_;  // since the last `lost` entry
  bool reopened_ = false;  // in a lost delivery
  std::uint32_t settings_due_ = 0;
  TapeCounters counters_;
  // Recorder thread, on its own cache lines.
  alignas(64) std::atomic<std::int64_t> attended_ns_{0};  // monotonic; 0: never
  std::optional<FlightEntryHead> begun_;
  bool begins_delivery_ = false;
};

}  // namespace ifog
