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
#include <cstddef>
#include <cstdint>
#include <string>

namespace ifog {

// State of the reader thread: samples as passed on, bytes and frames at the end of the last delivery (within
// one the driver's counters are incomplete).
struct ReaderBooks {
  std::uint64_t bytes_read = 0, bytes_framed = 0, bytes_skipped = 0, bytes_pending = 0;
  // CAN frames read; for byte drivers the good and bad ones found
  std::uint64_t frames_read = 0, frames_good = 0, frames_refused = 0, frames_other = 0;
  std::uint64_t decoded = 0, samples = 0, repeated = 0;
};

// State of the filter between two increments.
struct FilterBooks {
  std::uint64_t samples = 0;                       // device samples in all increments from the queue
  std::uint64_t sent = 0, failed = 0, merged = 0;  // messages; merged: samples beyond a message's first
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
  std::atomic<std::uint32_t> version_{0};  // odd: being written
  std::array<std::atomic<std::uint64_t>, 11> entries_{};
};

}  // namespace ifog
