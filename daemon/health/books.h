// SPDX-License-Identifier: Apache-2.0
// Accounts of one pipeline: everything received and what became of it, so that no loss is silent. At every
// moment
//   bytes read      = bytes of frames + bytes skipped + bytes of an incomplete frame
//   CAN frames read = frames decoded + frames refused + frames that are none of the sensor's
//   samples decoded = samples + duplicates
//   samples         = samples sent, alone or merged, + samples in messages that LCM rejected
//                     + samples on their way to the filter
// Each term has a counter in the status message.
#pragma once

#include <array>
#include <atomic>
#include <cstdint>
#include <string>
#include <tuple>
#include <type_traits>

#include "drivers/ifog/driver.h"
#include "drivers/transport/transport.h"
#include "filters/chain/incrementer.h"

namespace ifog {

// State of the reader thread: `decoded` and `counts` as passed on, all else at the end of the last delivery
// (within one the driver's counters are incomplete).
struct ReaderBooks {
  std::uint64_t decoded = 0;
  IncrementerCounts counts{};
  ifog_driver_counters driver{};
  TransportCounters line{};
  std::uint64_t turns = 0;
  std::uint64_t stood_back = 0;    // number of pauses, see ProcessorShare
  std::uint64_t bytes_at_end = 0;  // incomplete last frame of a file; also in driver.bytes_skipped
  std::uint64_t channel_refused = 0, channel_drops = 0;  // of ChannelTable
  // Of the Incrementer.
  std::uint64_t axes_seen = 0, mixed = 0;
  double clock_offset_ppm = 0.0, interval_error = 0.0;
};

// State of the filter between two increments. Messages, if not stated otherwise.
struct FilterBooks {
  std::uint64_t samples = 0;                       // device samples in all increments from the queue
  std::uint64_t sent = 0, failed = 0, merged = 0;  // merged: samples beyond a message's first
  std::uint64_t channel_stale = 0, out_of_range = 0, corrections_refused = 0;
  std::uint64_t imu_failures = 0;   // messages besides rate_t that LCM rejected
  std::uint64_t filter_resets = 0;  // times
  std::uint64_t stood_back = 0;     // number of pauses, see ProcessorShare
};

// "", or the identity that is violated, with its numbers. `filter` must be older than `reader`.
std::string imbalance(const ReaderBooks& reader, const FilterBooks& filter);

// Written by the reader thread, read consistently by others: a sequence lock (H.-J. Boehm, "Can Seqlocks Get
// Along With Programming Language Memory Models?", MSPC 2012). The writer never waits.
class SharedBooks {
 public:
  void write(const ReaderBooks& books) noexcept;
  // For threads that may wait for the writer.
  [[nodiscard]] ReaderBooks read() const noexcept;
  // For threads that must not wait, as they may block the writer's processor. False: the writer is writing.
  bool try_read(ReaderBooks& out) const noexcept;

 private:
  using Words = std::array<std::uint64_t, sizeof(ReaderBooks) / sizeof(std::uint64_t)>;
  static_assert(std::is_trivially_copyable_v<ReaderBooks> && sizeof(Words) == sizeof(ReaderBooks));
  std::atomic<std::uint32_t> version_{0};  // odd: being written
  std::array<std::atomic<std::uint64_t>, std::tuple_size_v<Words>> words_{};
};

}  // namespace ifog
