// SPDX-License-Identifier: Apache-2.0
// Reason why a thread makes no progress: starved if it is ready but gets no processor (something has higher
// priority); stuck if it waits or does not finish.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

namespace ifog {

// Fields of /proc/self/task/TID/stat.
struct ThreadTime {
  char state = '?';         // R: running or ready
  std::uint64_t ticks = 0;  // processor time, including the kernel
};
[[nodiscard]] ThreadTime parse_thread_stat(std::string_view text);

// Ready both times, without processor time between.
[[nodiscard]] bool starved_between(const ThreadTime& before, const ThreadTime& now);

class ThreadWatch {
 public:
  // For the watched thread.
  void begin() noexcept;
  // For one other thread: true if it was starved since the last call.
  [[nodiscard]] bool starved();

 private:
  std::atomic<int> thread_{0};
  ThreadTime before_;
};

}  // namespace ifog
