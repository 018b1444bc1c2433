// SPDX-License-Identifier: Apache-2.0
// Reads a descriptor until a deadline, or until another thread or a signal handler stops it.
#pragma once

#include <poll.h>
#include <sys/types.h>

#include <atomic>
#include <cerrno>
#include <csignal>
#include <cstdint>
#include <ctime>

namespace ifog {

// Deadline for blocking system calls.
//
// A poll() before each read() costs more than the read itself (tests/bench/latency). A thread that reads
// without poll() has its own timer that sends a signal (SIGURG, as in Go's runtime: ignored by default and
// unused here): the call is interrupted and returns EINTR. A signal between the last check and the call would
// be lost, so it repeats every millisecond while the thread is at its call. With steady traffic the timer is
// set once per deadline; an early alarm is set again.
class ReadAlarm {
 public:
  // Creates the timer at the thread's first call. If that fails, set() returns false.
  static ReadAlarm& of_this_thread() noexcept;
  ~ReadAlarm();
  ReadAlarm(const ReadAlarm&) = delete;
  ReadAlarm& operator=(const ReadAlarm&) = delete;

  // True if it rings at or before `until_ns` of CLOCK_MONOTONIC.
  [[nodiscard]] bool is_set(std::int64_t until_ns) noexcept;
  // False: no timer is available.
  bool set(std::int64_t until_ns) noexcept;
  // Stops it, for system calls that must not be interrupted.
  void off() noexcept;

  // To be called around the system call. enter() is false if it has rung since it was set: then the call must
  // be omitted.
  [[nodiscard]] bool enter() noexcept;
  void leave() noexcept;

  // For ring(); −1: none.
  [[nodiscard]] int number() const noexcept { return number_; }
  // From any thread or signal handler: the thread of this alarm returns from its call, or does not enter it.
  // Has no effect after that thread's alarm is gone.
  static void ring(int number) noexcept;

 private:
  ReadAlarm() noexcept;
  static constexpr std::int64_t kNever = INT64_MAX;
  int number_ = -1;               // kernel's id of the timer
  std::int64_t set_ns_ = kNever;  // time of ringing
};

class StoppableWait {
 public:
  // Throws std::runtime_error if no eventfd is available.
  StoppableWait();
  ~StoppableWait();
  StoppableWait(const StoppableWait&) = delete;
  StoppableWait& operator=(const StoppableWait&) = delete;

  // Ends the present wait and all later ones.
  void stop() noexcept;
  [[nodiscard]] bool stopped() const { return stopped_.load(std::memory_order_relaxed); }

  enum class Wake { ready, timeout, stopped };
  // Waits for `events` on fd (only for time and stop() if fd is −1). `happened` gets poll's result.
  Wake wait(int fd, short events, std::int64_t until_ns, short& happened) noexcept;

  // Result of a reading system call.
  struct Received {
    Wake wake = Wake::ready;
    ssize_t n = 0;       // return value
    int error = 0;       // errno if that is negative; never EINTR from a blocking descriptor
    short happened = 0;  // poll's result, if the call returned no data
  };
  // Reads `fd` once with `call(bool may_wait)`, waiting until `until_ns` or stop(). A blocking descriptor
  // needs one system call, which the thread's alarm may interrupt. Others are polled first.
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
  // Makes a descriptor blocking. False: not possible, so it must be polled.
  static bool let_block(int fd) noexcept;

 private:
  enum class Entry { call, poll_first, stopped };
  // Tells if a waiting call may be made now: `call` if it will be interrupted in time; then leave_call() must
  // follow.
  Entry enter_call(std::int64_t until_ns) noexcept;
  static void leave_call() noexcept { ReadAlarm::of_this_thread().leave(); }
  static short happened_to(int fd) noexcept;

  int event_;  // set by stop() and never read, so all later waits return at once
  // Alarm of the reading thread. Sequentially consistent with stopped_: either stop() finds the alarm and
  // rings, or the reader sees stopped_.
  std::atomic<int> alarm_{-1};
  // Waits are ended by the event, not by this flag.
  std::atomic<bool> stopped_{false};
};

}  // namespace ifog
