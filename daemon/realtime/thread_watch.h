// SPDX-License-Identifier: Apache-2.0
// Why a thread makes no progress. If it is ready to run and gets no processor, it is starved by something
// of a higher priority, and nothing is wrong with it. One that waits, or works and does not come to an end,
// is stuck.
#pragma once

#include <atomic>
#include <cstdint>
#include <string_view>

namespace ifog {

// The fields of /proc/self/task/TID/stat.
struct ThreadTime {
  char state = '?';         // R: running, or ready to
  std::uint64_t ticks = 0;  // of processor, in the kernel, too
};
[[nodiscard]] ThreadTime parse_thread_stat(std::string_view text);

// Ready both times, and had no processor between them.
[[nodiscard]] bool starved_between(const ThreadTime& before, const ThreadTime& now);

class ThreadWatch {
 public:
  // The thread that is watched.
  void begin() noexcept;
  // Any one other thread: whether it was starved since this was asked last.
  [[nodiscard]] bool starved();

 private:
  std::atomic<int> thread_{0};
  ThreadTime before_;
};

}  // namespace ifog
