// SPDX-License-Identifier: Apache-2.0
// How much of a processor the threads of a sensor may take. One that babbles sends without an end, and in
// real time its threads would leave nothing to whatever shares their processor: the filters of other sensors
// first, which under SCHED_FIFO get their turn only when those before them sleep. So a thread that comes to
// its share over a tenth of a second stands back for as long as its share asks. What comes meanwhile waits in
// the kernel or is dropped there, or is merged, and is counted.
#pragma once

#include <algorithm>
#include <cstdint>

namespace ifog {

class ProcessorShare {
 public:
  // now_ns: of any clock, while the thread is at work. used_ns(): time it has worked so far, asked for only
  // at the end of a window, since to know it may take a system call. How long it must stand back first, ns;
  // mostly 0.
  template <typename Used>
  [[nodiscard]] std::int64_t rest_ns(std::int64_t now_ns, Used&& used_ns) noexcept {
    const std::int64_t elapsed_ns = now_ns - begin_ns_;
    if (started_ && elapsed_ns < kWindow_ns) return 0;
    const std::int64_t used = used_ns();
    const std::int64_t rest =
        started_ ? std::clamp<std::int64_t>((used - used_ns_) * kOf / kShare - elapsed_ns, 0, kLongestRest_ns)
                 : 0;
    started_ = true;
    begin_ns_ = now_ns + rest;
    used_ns_ = used;
    return rest;
  }

 private:
  static constexpr std::int64_t kShare = 3, kOf = 4;  // three quarters
  static constexpr std::int64_t kWindow_ns = 100'000'000;
  // Of a window that was all work. Longer work than that is none: the process was stopped, the machine slept.
  static constexpr std::int64_t kLongestRest_ns = kWindow_ns * (kOf - kShare) / kShare;
  bool started_ = false;
  std::int64_t begin_ns_ = 0, used_ns_ = 0;
};

}  // namespace ifog
