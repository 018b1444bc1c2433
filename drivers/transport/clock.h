// SPDX-License-Identifier: Apache-2.0
// The clocks of everything that arrives.
//
// Intervals come from a clock that nobody sets and nobody slews: what is integrated or counted must not move
// when somebody sets the date, and NTP may slew CLOCK_MONOTONIC and CLOCK_BOOTTIME by 8 %. The arrival clock
// is CLOCK_MONOTONIC_RAW plus the time that the machine slept (CLOCK_BOOTTIME less CLOCK_MONOTONIC), counted
// from the epoch as the wall clock had it when the process started. So its numbers read like times of day,
// and recorded times (a log's) and live ones are of one kind. The wall clock only labels: a time of day is a
// time of the arrival clock plus wall_shift_ns(), which follows a slewed wall clock in small steps.
#pragma once

#include <cstdint>

namespace ifog {

// CLOCK_REALTIME, the wall clock, and CLOCK_MONOTONIC, in which the system takes deadlines; ns.
std::int64_t realtime_ns() noexcept;
std::int64_t monotonic_ns() noexcept;

// Time that the calling thread has had of a processor, in the kernel, too, ns. A system call.
std::int64_t thread_time_ns() noexcept;

// The arrival clock, ns since the epoch as the wall clock had it when the process started.
std::int64_t arrival_clock_ns() noexcept;
// What it would have shown when the machine was switched on.
std::int64_t arrival_clock_at_boot_ns() noexcept;

// How far the wall clock has been set since the process started, ns. Exactly the same value until somebody
// sets it by more than the reading of two clocks can tell (50 µs, and for a thread that others of its
// priority hold up between the two as much more): a label must not jitter.
class WallShift {
 public:
  // Now; `arrival`: a reading of the arrival clock made just before. Reads both clocks again
  // where that was too long ago to tell. No allocation, no system call where the clocks need none.
  std::int64_t at(std::int64_t arrival) noexcept;
  // The same from readings of the two clocks; doubt_ns: by how much they may not be of one time.
  std::int64_t from(std::int64_t realtime, std::int64_t arrival, std::int64_t doubt_ns = 0) noexcept;

 private:
  std::int64_t shift_ns_ = 0;
};

// The kernel stamps what it receives with the wall clock. Here such stamps are put on the arrival clock, also
// where the wall clock was set while they waited to be read.
class KernelStamps {
 public:
  // When the source is opened, and before the stamps of each read: both clocks as they stand.
  void begin(std::int64_t realtime, std::int64_t arrival) noexcept;
  // Never later than begin()'s time. Stamps of one read in order.
  std::int64_t on_arrival_clock(std::int64_t stamp_ns) noexcept;

 private:
  std::int64_t now_ns_ = 0, begun_ns_ = 0, latest_ns_ = 0;
  std::int64_t before_ns_ = 0, after_ns_ = 0;  // wall clock less arrival clock, at the read before and now
  bool started_ = false, stepped_ = false;
};

}  // namespace ifog
