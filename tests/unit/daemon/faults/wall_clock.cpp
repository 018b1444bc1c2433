// SPDX-License-Identifier: Apache-2.0
#include "tests/unit/daemon/faults/wall_clock.h"

#include <atomic>
#include <ctime>

namespace {

std::atomic<std::int64_t> offset_ns{0};

}  // namespace

namespace ifog {

void set_wall_clock(std::int64_t offset) noexcept { offset_ns.store(offset); }

}  // namespace ifog

extern "C" {
// The names that the linker gives the system's function and this one in its place.
int __real_clock_gettime(clockid_t clock, timespec* time);  // NOLINT(bugprone-reserved-identifier)
int __wrap_clock_gettime(clockid_t clock, timespec* time);  // NOLINT(bugprone-reserved-identifier)

int __wrap_clock_gettime(clockid_t clock, timespec* time) {  // NOLINT(bugprone-reserved-identifier)
  const int result = __real_clock_gettime(clock, time);
  if (clock != CLOCK_REALTIME || result != 0) return result;
  constexpr std::int64_t kSecond_ns = 1'000'000'000;
  const std::int64_t ns = time->tv_sec * kSecond_ns + time->tv_nsec + offset_ns.load();
  time->tv_sec = ns / kSecond_ns;
  time->tv_nsec = ns % kSecond_ns;
  return result;
}
}
