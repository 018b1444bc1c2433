// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/clock.h"

#include <algorithm>
#include <atomic>
#include <cstdlib>
#include <ctime>
#include <utility>

namespace ifog {
namespace {

// Two clocks read in sequence differ by the thread's delay between.
constexpr std::int64_t kSame_ns = 50'000;
constexpr int kTries = 5;

std::int64_t clock_ns(clockid_t clock) noexcept {
  timespec now{};
  clock_gettime(clock, &now);
  return static_cast<std::int64_t>(now.tv_sec) * 1'000'000'000 + now.tv_nsec;
}

// Limit of a slewed clock's error rate (chrony's maxslewrate is 1/12).
constexpr std::int64_t kSlews = 8;

// Time asleep since boot: constant until the computer sleeps. Both ends of the interval are valid, even if the
// thread was delayed between two readings.
class TimeAsleep {
 public:
  std::int64_t at(std::int64_t raw_ns) noexcept {
    const std::int64_t asleep = asleep_ns_.load(std::memory_order_relaxed);
    if (raw_ns - asked_ns_.load(std::memory_order_relaxed) < kAsk_ns) return asleep;
    asked_ns_.store(raw_ns, std::memory_order_relaxed);
    const std::int64_t before = clock_ns(CLOCK_MONOTONIC);
    const std::int64_t boot = clock_ns(CLOCK_BOOTTIME);
    const std::int64_t after = clock_ns(CLOCK_MONOTONIC);
    if (boot - after <= asleep && asleep <= boot - before) return asleep;
    const std::int64_t now = std::max<std::int64_t>(0, boot - after);
    asleep_ns_.store(now, std::memory_order_relaxed);
    return now;
  }

 private:
  static constexpr std::int64_t kAsk_ns = 1'000'000;  // a clock costs 80 ns to read; sleep is longer

  std::atomic<std::int64_t> asleep_ns_{0}, asked_ns_{0};
};

// CLOCK_MONOTONIC_RAW plus the time asleep.
std::int64_t unslewed_ns() noexcept {
  static TimeAsleep asleep;
  const std::int64_t raw_ns = clock_ns(CLOCK_MONOTONIC_RAW);
  return raw_ns + asleep.at(raw_ns);
}

// Wall clock - unslewed clock, from the try with the least delay, and its uncertainty.
struct WallLess {
  std::int64_t ns, doubt_ns;
};
WallLess wall_less_unslewed() noexcept {
  std::int64_t best = 0, least = INT64_MAX;
  for (int i = 0; i < kTries; ++i) {
    const std::int64_t before = unslewed_ns();
    const std::int64_t wall = clock_ns(CLOCK_REALTIME);
    const std::int64_t took = unslewed_ns() - before;
    if (took >= least) continue;
    least = took;
    best = wall - before - took / 2;
  }
  return {best, least / 2};
}

const WallLess& at_start() noexcept {
  static const WallLess at_start_of_process = wall_less_unslewed();
  return at_start_of_process;
}
std::int64_t epoch_ns() noexcept { return at_start().ns; }

// At process start, not at the first sample.
[[maybe_unused]] const std::int64_t taken_at_start = epoch_ns();

}  // namespace

std::int64_t realtime_ns() noexcept { return clock_ns(CLOCK_REALTIME); }
std::int64_t monotonic_ns() noexcept { return clock_ns(CLOCK_MONOTONIC); }
std::int64_t thread_time_ns() noexcept { return clock_ns(CLOCK_THREAD_CPUTIME_ID); }
std::int64_t arrival_clock_ns() noexcept { return unslewed_ns() + epoch_ns(); }
std::int64_t arrival_clock_at_boot_ns() noexcept { return epoch_ns(); }

std::int64_t WallShift::from(std::int64_t realtime, std::int64_t arrival, std::int64_t doubt_ns) noexcept {
  const std::int64_t shift = realtime - arrival;
  if (std::abs(shift - shift_ns_) > kSame_ns + doubt_ns) shift_ns_ = shift;
  return shift_ns_;
}

std::int64_t WallShift::at(std::int64_t arrival) noexcept {
  if (std::abs(realtime_ns() - arrival - shift_ns_) <= kSame_ns) return shift_ns_;
  const WallLess now = wall_less_unslewed();
  return from(now.ns - epoch_ns(), 0, now.doubt_ns + at_start().doubt_ns);
}

void KernelStamps::begin(std::int64_t realtime, std::int64_t arrival) noexcept {
  now_ns_ = arrival;
  before_ns_ = started_ ? after_ns_ : realtime - arrival;
  after_ns_ = realtime - arrival;
  // Without other evidence waiting data were stamped before the clock was set. Slewing is not counted as
  // setting.
  const std::int64_t slewed_ns = (arrival - std::exchange(begun_ns_, arrival)) / kSlews;
  stepped_ = std::abs(after_ns_ - before_ns_) <= kSame_ns + slewed_ns;
  if (!started_) latest_ns_ = INT64_MIN;
  started_ = true;
}

std::int64_t KernelStamps::on_arrival_clock(std::int64_t stamp_ns) noexcept {
  const auto fits = [this](std::int64_t time) { return time >= latest_ns_ && time <= now_ns_ + kSame_ns; };
  std::int64_t time = stamp_ns - (stepped_ ? after_ns_ : before_ns_);
  if (!stepped_ && !fits(time)) {
    stepped_ = true;
    time = stamp_ns - after_ns_;
    // Set several times while it waited: only the present time is known.
    if (!fits(time)) time = now_ns_;
  }
  time = std::min(time, now_ns_);
  latest_ns_ = time;
  return time;
}

}  // namespace ifog
