// SPDX-License-Identifier: Apache-2.0
// The books of one pipeline: all that was received, and where it went. Nothing is lost in silence, so at
// every moment
//   bytes read      = bytes of frames + bytes skipped + bytes of a frame that is not complete yet
//   CAN frames read = frames decoded + frames refused + frames that are none of the sensor's
//   samples decoded = samples + duplicates
//   samples         = samples sent, alone or merged into another one's message, + samples in messages that
//                     LCM did not take + samples on their way to the filter
// and each way out has its counter in the status message.
#pragma once

#include <array>
#include <atomic>
#include <cstddef>
#include <cstdint>
#include <string>

namespace ifog {

// One moment of the reader thread: the samples as they are handed on, bytes and frames as of the end of
// the last delivery, since within one the driver has not yet said what became of them.
struct ReaderBooks {
  std::uint64_t bytes_read = 0, bytes_framed = 0, bytes_skipped = 0, bytes_pending = 0;
  // Read, of CAN; a driver of bytes counts here the good and bad ones that it finds in them.
  std::uint64_t frames_read = 0, frames_good = 0, frames_refused = 0, frames_other = 0;
  std::uint64_t decoded = 0, samples = 0, repeated = 0;
};

// One moment of the filter, between two increments.
struct FilterBooks {
  std::uint64_t samples = 0;                       // of the device, in all increments from the queue
  std::uint64_t sent = 0, failed = 0, merged = 0;  // messages; merged: samples beyond a message's first
};

// "", or the identity that does not hold, with its numbers. `filter` is from before `reader`.
std::string imbalance(const ReaderBooks& reader, const FilterBooks& filter);

// Written by the reader thread, read as a whole by others: a sequence lock (H.-J. Boehm, "Can Seqlocks Get
// Along With Programming Language Memory Models?", MSPC 2012). The writer never waits.
class SharedBooks {
 public:
  void write(const ReaderBooks& books) noexcept;
  // For a thread that may wait for the writer.
  [[nodiscard]] ReaderBooks read() const noexcept;
  // For a thread that may not wait, since it may hold the writer's processor. False: the writer is writing.
  bool try_read(ReaderBooks& out) const noexcept;

 private:
  std::atomic<std::uint32_t> version_{0};  // odd: being written
  std::array<std::atomic<std::uint64_t>, 11> entries_{};
};

}  // namespace ifog
