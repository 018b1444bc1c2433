// SPDX-License-Identifier: Apache-2.0
// Limits the processor time of a sensor's threads. A faulty sensor that sends without pause would, with
// real-time priority, block other threads on its processor, first the filters of other sensors. So a thread
// that reaches its share within 0.1 s pauses for the corresponding time. If several together reach it, the
// busy ones pause at the same time. Data meanwhile wait in the kernel, are dropped there, or are merged, and
// are counted.
#pragma once

#include <algorithm>
#include <atomic>
#include <cstdint>

namespace ifog {

// Common data of threads on the same processors.
class SharedProcessors {
 public:
  // processors: their number, > 0.
  explicit SharedProcessors(int processors) noexcept : processors_(processors) {}

  // End of the present pause for busy threads.
  [[nodiscard]] std::int64_t quiet_until_ns() const noexcept {
    return quiet_until_ns_.load(std::memory_order_relaxed);
  }
  // For each of the threads, about ten times a second: work since the last call.
  void add(std::int64_t now_ns, std::int64_t worked_ns) noexcept {
    worked_ns_.fetch_add(worked_ns, std::memory_order_relaxed);
    std::int64_t begin = begin_ns_.load(std::memory_order_relaxed);
    if (begin != kNever && now_ns - begin < kWindow_ns) return;
    // One thread ends the window; simultaneous additions count for the next one.
    if (!begin_ns_.compare_exchange_strong(begin, now_ns, std::memory_order_relaxed)) return;
    const std::int64_t worked = worked_ns_.exchange(0, std::memory_order_relaxed);
    if (begin == kNever) return;
    // Up to two windows of work, as each thread reports at the end of its own.
    const std::int64_t rest = std::min(worked * kOf / kShare / processors_ - (now_ns - begin), kWindow_ns);
    if (rest <= 0) return;
    begin_ns_.store(now_ns + rest, std::memory_order_relaxed);
    quiet_until_ns_.store(now_ns + rest, std::memory_order_relaxed);
  }

  static constexpr std::int64_t kShare = 3, kOf = 4;  // three quarters
  static constexpr std::int64_t kWindow_ns = 100'000'000;
  // Pause after a fully used window. Longer work is not real: the process was stopped or the computer slept.
  static constexpr std::int64_t kLongestRest_ns = kWindow_ns * (kOf - kShare) / kShare;

 private:
  static constexpr std::int64_t kNever = INT64_MIN / 2;  // any time minus this is a time
  const int processors_;
  std::atomic<std::int64_t> begin_ns_{kNever}, worked_ns_{0}, quiet_until_ns_{kNever};
};

class ProcessorShare {
 public:
  // shared: null if the thread is alone; all must use one clock.
  explicit ProcessorShare(SharedProcessors* shared = nullptr) noexcept : shared_(shared) {}

  // now_ns: of any clock, while the thread is working. used_ns(): its work so far, called only at the end of
  // a window, as it may be a system call. Returns the pause that is due, ns; mostly 0.
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
    // At most what others may ask for; if the thread was delayed, now_ns is old.
    if (shared_ != nullptr && takes_much_)
      rest = std::max(rest, std::min(shared_->quiet_until_ns() - now_ns, SharedProcessors::kWindow_ns));
    if (ends) begin_ns_ = now_ns + rest;
    return rest;
  }

 private:
  std::int64_t of_window(std::int64_t now_ns, std::int64_t elapsed_ns, std::int64_t worked_ns) noexcept {
    if (shared_ != nullptr) {
      // Fading by one half per window: a thread that waited for the processor uses it in the next window.
      const double part = static_cast<double>(worked_ns) / static_cast<double>(elapsed_ns);
      part_ = 0.5 * (part_ + part);
      takes_much_ = part_ > kMuch;
      shared_->add(now_ns, std::min(worked_ns, elapsed_ns));
    }
    return std::clamp<std::int64_t>(worked_ns * SharedProcessors::kOf / SharedProcessors::kShare - elapsed_ns,
                                    0, SharedProcessors::kLongestRest_ns);
  }

  // Share of a processor; a 5 kHz sensor needs 5 % if an IMU frame takes 10 µs.
  static constexpr double kMuch = 0.1;
  SharedProcessors* shared_;
  double part_ = 0.0;
  bool started_ = false, takes_much_ = false;
  std::int64_t begin_ns_ = 0, used_ns_ = 0;
};

}  // namespace ifog
