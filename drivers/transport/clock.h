// SPDX-License-Identifier: Apache-2.0
// Clocks of everything that arrives.
//
// Intervals are by a clock that is neither set nor slewed: integrals and counts must not depend on changes of
// the date, and NTP may slew CLOCK_MONOTONIC and CLOCK_BOOTTIME by 8 %. The arrival clock is
// CLOCK_MONOTONIC_RAW plus the time asleep (CLOCK_BOOTTIME - CLOCK_MONOTONIC), starting at the wall clock's
// time at process start. So its values look like times of day, and recorded and live times are alike. The
// wall clock is only for labels: time of day = arrival clock + wall_shift_ns(), which follows a slewed wall
// clock in small steps.
#pragma once

#include <cstdint>

namespace ifog {

// CLOCK_REALTIME (wall clock) and CLOCK_MONOTONIC (deadlines), in ns.
std::int64_t realtime_ns() noexcept;
std::int64_t monotonic_ns() noexcept;

// Processor time of the calling thread including the kernel, ns. A system call.
std::int64_t thread_time_ns() noexcept;

// Arrival clock, ns since the epoch according to the wall clock at process start.
std::int64_t arrival_clock_ns() noexcept;
// Arrival clock at boot.
std::int64_t arrival_clock_at_boot_ns() noexcept;

// Change of the wall clock since the process started, ns. Constant until the clock is set by more than the
// resolution of two readings (50 µs, more if the thread was delayed between them). So labels do not jitter.
class WallShift {
 public:
  // Present shift. arrival: a reading of the arrival clock just before; both clocks are read again if it is
  // too old. No allocation; no system call where the clocks need none.
  std::int64_t at(std::int64_t arrival) noexcept;
  // The same from readings of both clocks; doubt_ns: their largest time difference.
  std::int64_t from(std::int64_t realtime, std::int64_t arrival, std::int64_t doubt_ns = 0) noexcept;

 private:
  std::int64_t shift_ns_ = 0;
};

// Converts the kernel's wall-clock stamps to the arrival clock, also if the wall clock was set while data
// waited.
class KernelStamps {
 public:
  // To be called when the source is opened, and before the stamps of each read, with both clocks.
  void begin(std::int64_t realtime, std::int64_t arrival) noexcept;
  // Never later than begin()'s time. Stamps of one read must be passed in order.
  std::int64_t on_arrival_clock(std::int64_t stamp_ns) noexcept;

 private:
  std::int64_t now_ns_ = 0, begun_ns_ = 0, latest_ns_ = 0;
  std::int64_t before_ns_ = 0, after_ns_ = 0;  // wall clock - arrival clock, at the previous read and now
  bool started_ = false, stepped_ = false;
};

}  // namespace ifog
