// SPDX-License-Identifier: Apache-2.0
// How much of a processor the threads of a sensor may take. One that babbles sends without an end, and in
// real time its threads would leave nothing to whatever shares their processor: the filters of other sensors
// first, which under SCHED_FIFO get their turn only when those before them sleep. So a thread that comes to
// its share over a tenth of a second stands back for as long as its share asks; and where several together
// come to it, those of them that take much stand back at the same time, or each would only make room for the
// next. What comes meanwhile waits in the kernel or is dropped there, or is merged, and is counted.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace ifog {

// What threads share that run on the same processors.
class SharedProcessors {
 public:
  // processors > 0: how many they are.
  explicit SharedProcessors(int processors) noexcept : processors_(processors) {}

  // Until then whoever takes much stands back.
  [[nodiscard]] std::int64_t quiet_until_ns() const noexcept {
    return quiet_until_ns_.load(std::memory_order_relaxed);
  }
  // Any of the threads, about ten times a second: so much it has worked since the last time.
  void add(std::int64_t now_ns, std::int64_t worked_ns) noexcept {
    worked_ns_.fetch_add(worked_ns, std::memory_order_relaxed);
    std::int64_t begin = begin_ns_.load(std::memory_order_relaxed);
    if (begin != kNever && now_ns - begin < kWindow_ns) return;
    // One of them ends the window; what another adds just then belongs to the next.
    if (!begin_ns_.compare_exchange_strong(begin, now_ns, std::memory_order_relaxed)) return;
    const std::int64_t worked = worked_ns_.exchange(0, std::memory_order_relaxed);
    if (begin == kNever) return;
    // A window may be two: each thread tells at the end of its own.
    const std::int64_t rest = std::min(worked * kOf / kShare / processors_ - (now_ns - begin), kWindow_ns);
    if (rest <= 0) return;
    begin_ns_.store(now_ns + rest, std::memory_order_relaxed);
    quiet_until_ns_.store(now_ns + rest, std::memory_order_relaxed);
  }

  static constexpr std::int64_t kShare = 3, kOf = 4;  // three quarters
  static constexpr std::int64_t kWindow_ns = 100'000'000;
  // The rest behind a window that was all work. Longer work is none: the process was stopped, the machine slept.
  static constexpr std::int64_t kLongestRest_ns = kWindow_ns * (kOf - kShare) / kShare;

 private:
  static constexpr std::int64_t kNever = INT64_MIN / 2;  // any time less it is a time
  const int processors_;
  std::atomic<std::int64_t> begin_ns_{kNever}, worked_ns_{0}, quiet_until_ns_{kNever};
};

class ProcessorShare {
 public:
  // shared: with whom, or null for nobody; all of them tell the time by one clock.
  explicit ProcessorShare(SharedProcessors* shared = nullptr) noexcept : shared_(shared) {}

  // now_ns: of any clock, while the thread is at work. used_ns(): time it has worked so far, asked for only
  // at the end of a window, since to know it may take a system call. How long it must stand back first, ns;
  // mostly 0.
  template <typename Used>
  [[nodiscard]] std::int64_t rest_ns(std::int64_t now_ns, Used&& used_ns) noexcept {
    std::int64_t rest = 0;
    const std::int64_t elapsed_ns = now_ns - begin_ns_;
    const bool ends = !started_ || elapsed_ns >= SharedProcessors::kWindow_ns;
    if (ends) {
      const std::int64_t used = used_ns();
      if (started_) rest = of_window(now_ns, elapsed_ns, used - used_ns_);
      started_ = true;
      used_ns_ = used;
    }
    // No longer than others may ask for: where the thread was delayed since, now_ns is some time ago.
    if (shared_ != nullptr && takes_much_)
      rest = std::max(rest, std::min(shared_->quiet_until_ns() - now_ns, SharedProcessors::kWindow_ns));
    if (ends) begin_ns_ = now_ns + rest;
    return rest;
  }

 private:
  std::int64_t of_window(std::int64_t now_ns, std::int64_t elapsed_ns, std::int64_t worked_ns) noexcept {
    if (shared_ != nullptr) {
      // Half of it forgotten each time: who waited for the processor in one window takes it in the next.
      const double part = static_cast<double>(worked_ns) / static_cast<double>(elapsed_ns);
      part_ = 0.5 * (part_ + part);
      takes_much_ = part_ > kMuch;
      shared_->add(now_ns, std::min(worked_ns, elapsed_ns));
    }
    return std::clamp<std::int64_t>(worked_ns * SharedProcessors::kOf / SharedProcessors::kShare - elapsed_ns,
                                    0, SharedProcessors::kLongestRest_ns);
  }

  // Share of a processor; a sensor of 5 kHz needs a twentieth where an IMU's frame needs 10 µs.
  static constexpr double kMuch = 0.1;
  SharedProcessors* shared_;
  double part_ = 0.0;
  bool started_ = false, takes_much_ = false;
  std::int64_t begin_ns_ = 0, used_ns_ = 0;
};

}  // namespace ifog
