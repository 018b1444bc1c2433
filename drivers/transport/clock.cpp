// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/clock.h"

#include <algorithm>
#include <cstdlib>
#include <ctime>

namespace ifog {
namespace {

// Two clocks read one after the other differ by as long as the thread was held up in between.
constexpr std::int64_t kSame_ns = 50'000;
constexpr int kTries = 5;

std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

// Wall clock less CLOCK_BOOTTIME, of a few tries the one that was held up least, and how far off it may be.
struct WallLessBoot {
  std::int64_t ns, doubt_ns;
};
WallLessBoot wall_less_boot() noexcept {
  std::int64_t best = 0, least = INT64_MAX;
  for (int i = 0; i < kTries; ++i) {
    const std::int64_t before = clock_ns(CLOCK_BOOTTIME);
    const std::int64_t wall = clock_ns(CLOCK_REALTIME);
    const std::int64_t took = clock_ns(CLOCK_BOOTTIME) - before;
    if (took >= least) continue;
    least = took;
    best = wall - before - took / 2;
  }
  return {best, least / 2};
}

const WallLessBoot& at_start() noexcept {
  static const WallLessBoot taken = wall_less_boot();
  return taken;
}
std::int64_t epoch_ns() noexcept { return at_start().ns; }

// Taken when the process starts, not at the first sample.
[[maybe_unused]] const std::int64_t taken_at_start = epoch_ns();

}  // namespace

std::int64_t realtime_ns() noexcept { return clock_ns(CLOCK_REALTIME); }
std::int64_t monotonic_ns() noexcept { return clock_ns(CLOCK_MONOTONIC); }
std::int64_t thread_time_ns() noexcept { return clock_ns(CLOCK_THREAD_CPUTIME_ID); }
std::int64_t arrival_clock_ns() noexcept { return clock_ns(CLOCK_BOOTTIME) + epoch_ns(); }
std::int64_t arrival_clock_at_boot_ns() noexcept { return epoch_ns(); }

std::int64_t WallShift::from(std::int64_t realtime, std::int64_t arrival, std::int64_t doubt_ns) noexcept {
  const std::int64_t shift = realtime - arrival;
  if (std::abs(shift - shift_ns_) > kSame_ns + doubt_ns) shift_ns_ = shift;
  return shift_ns_;
}

std::int64_t WallShift::at(std::int64_t arrival) noexcept {
  if (std::abs(realtime_ns() - arrival - shift_ns_) <= kSame_ns) return shift_ns_;
  const WallLessBoot now = wall_less_boot();
  return from(now.ns - epoch_ns(), 0, now.doubt_ns + at_start().doubt_ns);
}

void KernelStamps::begin(std::int64_t realtime, std::int64_t arrival) noexcept {
  now_ns_ = arrival;
  before_ns_ = started_ ? after_ns_ : realtime - arrival;
  after_ns_ = realtime - arrival;
  // Until a stamp says otherwise what waited was stamped before the clock was set.
  stepped_ = std::abs(after_ns_ - before_ns_) <= kSame_ns;
  if (!started_) latest_ns_ = INT64_MIN;
  started_ = true;
}

std::int64_t KernelStamps::on_arrival_clock(std::int64_t stamp_ns) noexcept {
  const auto fits = [this](std::int64_t time) { return time >= latest_ns_ && time <= now_ns_ + kSame_ns; };
  std::int64_t time = stamp_ns - (stepped_ ? after_ns_ : before_ns_);
  if (!stepped_ && !fits(time)) {
    stepped_ = true;
    time = stamp_ns - after_ns_;
    // Set more than once while it waited: nothing is known but that it is here.
    if (!fits(time)) time = now_ns_;
  }
  time = std::min(time, now_ns_);
  latest_ns_ = time;
  return time;
}

}  // namespace ifog
