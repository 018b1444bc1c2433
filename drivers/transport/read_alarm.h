// SPDX-License-Identifier: Apache-2.0
// A time limit for system calls that have none: those that read a descriptor that blocks.
//
// A poll() before each read() costs more than the read itself (tests/bench/latency). Who reads without it
// must still come back when its time is up or when another thread wants it to, so each thread that reads so
// has a timer of its own that sends it a signal (SIGURG, as the runtime of Go does: ignored by default, and
// used by nothing else here): the call is interrupted and returns EINTR. A signal that comes between the last
// look and the call would be lost; therefore it is repeated every millisecond for as long as the thread is at
// its call. Steady traffic sets the timer only once in a time limit: an alarm that rings too early is set again.
#pragma once

#include <atomic>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace ifog {

class ReadAlarm {
 public:
  // Makes the timer when a thread first asks. An alarm that could not be made says so by set().
  static ReadAlarm& of_this_thread() noexcept;
  ~ReadAlarm();
  ReadAlarm(const ReadAlarm&) = delete;
  ReadAlarm& operator=(const ReadAlarm&) = delete;

  // True: it rings at `until_ns` of CLOCK_MONOTONIC or before.
  [[nodiscard]] bool is_set(std::int64_t until_ns) noexcept;
  // False: the system has no timer left, or has none of this kind.
  bool set(std::int64_t until_ns) noexcept;
  // Does not ring any more; for system calls that nobody is to interrupt.
  void off() noexcept;

  // Around the system call. enter() is false when it has rung since it was set: then there is to be no call.
  [[nodiscard]] bool enter() noexcept;
  void leave() noexcept;

  // For ring(); −1: none.
  [[nodiscard]] int number() const noexcept { return number_; }
  // Any thread, also a signal handler: the thread whose alarm it is comes back from its call, or does not
  // enter it. A thread that has none any more is not disturbed.
  static void ring(int number) noexcept;

 private:
  ReadAlarm() noexcept;
  static constexpr std::int64_t kNever = INT64_MAX;
  int number_ = -1;               // the kernel's of the timer
  std::int64_t set_ns_ = kNever;  // when it rings
};

}  // namespace ifog
