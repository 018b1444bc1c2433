// SPDX-License-Identifier: Apache-2.0
// Reading a descriptor until a time, or until another thread or a signal handler says stop.
#pragma once

#include <poll.h>
#include <sys/types.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace ifog {

// A time limit for system calls that have none: those that read a descriptor that blocks.
//
// A poll() before each read() costs more than the read itself (tests/bench/latency). Who reads without it
// must still come back when its time is up or when another thread wants it to, so each thread that reads so
// has a timer of its own that sends it a signal (SIGURG, as the runtime of Go does: ignored by default, and
// used by nothing else here): the call is interrupted and returns EINTR. A signal that comes between the last
// look and the call would be lost; therefore it is repeated every millisecond for as long as the thread is at
// its call. Steady traffic sets the timer only once in a time limit: an alarm that rings too early is set again.
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

class StoppableWait {
 public:
  // Throws std::runtime_error when the system has no eventfd left.
  StoppableWait();
  ~StoppableWait();
  StoppableWait(const StoppableWait&) = delete;
  StoppableWait& operator=(const StoppableWait&) = delete;

  // Ends a wait at once and every later one immediately.
  void stop() noexcept;
  [[nodiscard]] bool stopped() const { return stopped_.load(std::memory_order_relaxed); }

  enum class Wake { ready, timeout, stopped };
  // Waits for `events` on fd (or for nothing but time and stop() when fd is −1). `happened` gets poll's
  // answer.
  Wake wait(int fd, short events, std::int64_t until_ns, short& happened) noexcept;

  // The outcome of a system call that reads.
  struct Received {
    Wake wake = Wake::ready;
    ssize_t n = 0;       // what it returned
    int error = 0;       // errno, where that is below 0; never EINTR from a descriptor that blocks
    short happened = 0;  // poll's answer, of a call that brought nothing
  };
  // Reads `fd` once by `call(bool may_wait)` when something is there: until `until_ns`, and until stop(). A
  // descriptor that blocks costs a single system call, for the waiting and the reading: `call` then waits
  // where it may, and is interrupted by the thread's alarm. Another one is polled first.
  template <typename Call>
  Received receive_by(int fd, bool blocks, std::int64_t until_ns, Call&& call) noexcept {
    Received got;
    const auto make = [&](bool may_wait) {
      got.n = call(may_wait);
      got.error = got.n < 0 ? errno : 0;
    };
    while (blocks) {
      const Entry entry = enter_call(until_ns);
      if (entry == Entry::stopped) return {.wake = Wake::stopped};
      if (entry == Entry::poll_first) break;
      make(true);
      leave_call();
      if (got.n > 0) return got;
      if (got.error == EINTR) continue;
      got.happened = happened_to(fd);
      return got;
    }
    got.wake = wait(fd, POLLIN, until_ns, got.happened);
    if (got.wake == Wake::ready) make(false);
    return got;
  }
  // Lets a descriptor block. False: it cannot, and is to be polled.
  static bool let_block(int fd) noexcept;

 private:
  enum class Entry { call, poll_first, stopped };
  // Whether a call that waits may be made now: `call` when it will be interrupted in time; leave_call() then
  // follows it.
  Entry enter_call(std::int64_t until_ns) noexcept;
  static void leave_call() noexcept { ReadAlarm::of_this_thread().leave(); }
  static short happened_to(int fd) noexcept;

  int event_;  // set by stop() and never read, so that every later wait returns at once
  // Alarm of the thread that reads. In one order with stopped_: either stop() finds it and rings, or the reader
  // finds that it is stopped.
  std::atomic<int> alarm_{-1};
  // A wait is woken by the event, not by this flag.
  std::atomic<bool> stopped_{false};
};

}  // namespace ifog
