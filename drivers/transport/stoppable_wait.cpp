// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/stoppable_wait.h"

#include <fcntl.h>
#include <sys/eventfd.h>
#include <sys/syscall.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <system_error>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

constexpr long kRepeat_ns = 1'000'000;

// State of the interrupted thread for the signal handler: lock-free atomics, as the standard requires.
thread_local std::atomic<int> t_number{-1};
thread_local std::atomic<bool> t_in_call{false}, t_rang{false};
static_assert(std::atomic<bool>::is_always_lock_free && std::atomic<int>::is_always_lock_free);

// System calls instead of glibc's, whose timer_t is a pointer and could be dangling in ring().
bool set_timer(int number, int flags, const itimerspec& when) noexcept {
  return syscall(SYS_timer_settime, number, flags, &when, nullptr) == 0;
}

void on_signal(int /*signal*/) {
  const int before = errno;
  t_rang.store(true, std::memory_order_relaxed);
  // A thread that was about to enter its call is reached by the next signal. Otherwise it checks before
  // entering.
  const int number = t_number.load(std::memory_order_relaxed);
  if (number >= 0 && !t_in_call.load(std::memory_order_relaxed)) set_timer(number, 0, itimerspec{});
  errno = before;
}

bool handle_signal() noexcept {
  struct sigaction action {};
  action.sa_handler = on_signal;  // without SA_RESTART, so that an interrupted call ends
  sigemptyset(&action.sa_mask);
  return sigaction(SIGURG, &action, nullptr) == 0;
}

}  // namespace

ReadAlarm& ReadAlarm::of_this_thread() noexcept {
  thread_local ReadAlarm alarm;
  return alarm;
}

ReadAlarm::ReadAlarm() noexcept {
  static const bool handled = handle_signal();
  if (!handled) return;
  sigset_t mine;
  sigemptyset(&mine);
  sigaddset(&mine, SIGURG);
  if (pthread_sigmask(SIG_UNBLOCK, &mine, nullptr) != 0) return;
  sigevent event{};
  event.sigev_notify = SIGEV_THREAD_ID;
  event.sigev_signo = SIGURG;
  event._sigev_un._tid = static_cast<pid_t>(syscall(SYS_gettid));
  int number = -1;
  if (syscall(SYS_timer_create, CLOCK_MONOTONIC, &event, &number) != 0) return;
  number_ = number;
  t_number.store(number, std::memory_order_relaxed);
}

ReadAlarm::~ReadAlarm() {
  if (number_ < 0) return;
  t_number.store(-1, std::memory_order_relaxed);
  syscall(SYS_timer_delete, number_);
}

bool ReadAlarm::is_set(std::int64_t until_ns) noexcept {
  if (t_rang.load(std::memory_order_relaxed)) {
    t_rang.store(false, std::memory_order_relaxed);
    set_ns_ = kNever;
  }
  return set_ns_ <= until_ns;
}

bool ReadAlarm::set(std::int64_t until_ns) noexcept {
  if (number_ < 0) return false;
  itimerspec when{};
  when.it_value = {until_ns / 1'000'000'000, until_ns % 1'000'000'000};
  when.it_interval.tv_nsec = kRepeat_ns;
  if (!set_timer(number_, TIMER_ABSTIME, when)) return false;
  set_ns_ = until_ns;
  return true;
}

void ReadAlarm::off() noexcept {
  if (set_ns_ != kNever) set_timer(number_, 0, itimerspec{});
  set_ns_ = kNever;
}

bool ReadAlarm::enter() noexcept {
  t_in_call.store(true, std::memory_order_relaxed);
  // The handler runs in this thread, so only the compiler must not reorder.
  std::atomic_signal_fence(std::memory_order_seq_cst);
  if (!t_rang.load(std::memory_order_relaxed)) return true;
  leave();
  return false;
}

void ReadAlarm::leave() noexcept { t_in_call.store(false, std::memory_order_relaxed); }

void ReadAlarm::ring(int number) noexcept {
  if (number < 0) return;
  const int before = errno;
  itimerspec now{};
  now.it_value.tv_nsec = 1;
  now.it_interval.tv_nsec = kRepeat_ns;
  set_timer(number, 0, now);
  errno = before;
}

StoppableWait::StoppableWait() : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (event_ < 0)
    throw std::runtime_error("cannot make an eventfd: " + std::generic_category().message(errno));
}

StoppableWait::~StoppableWait() { close(event_); }

void StoppableWait::stop() noexcept {
  const int before = errno;  // a signal handler must preserve errno
  stopped_.store(true);
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(event_, &one, sizeof one);
  ReadAlarm::ring(alarm_.load());
  errno = before;
}

StoppableWait::Wake StoppableWait::wait(int fd, short events, std::int64_t until_ns,
                                        short& happened) noexcept {
  happened = 0;
  for (;;) {
    std::array<pollfd, 2> fds{{{event_, POLLIN, 0}, {fd, events, 0}}};
    const std::int64_t left = std::max<std::int64_t>(0, until_ns - monotonic_ns());
    const timespec span{left / 1'000'000'000, left % 1'000'000'000};
    const int n = ppoll(fds.data(), fd < 0 ? 1 : 2, &span, nullptr);
    if (stopped() || (n > 0 && fds[0].revents != 0)) return Wake::stopped;
    if (n == 0) return Wake::timeout;
    if (n > 0) {
      happened = fds[1].revents;
      return Wake::ready;
    }
    // Interrupted by a signal: waits for the remaining time.
  }
}

StoppableWait::Entry StoppableWait::enter_call(std::int64_t until_ns) noexcept {
  ReadAlarm& alarm = ReadAlarm::of_this_thread();
  if (alarm.number() != alarm_.load(std::memory_order_relaxed)) alarm_.store(alarm.number());
  do {
    if (!alarm.is_set(until_ns) && (until_ns <= monotonic_ns() || !alarm.set(until_ns)))
      return Entry::poll_first;
    // After the alarm is set, so that stop()'s ringing is not overwritten.
    if (stopped_.load()) return Entry::stopped;
  } while (!alarm.enter());
  return Entry::call;
}

short StoppableWait::happened_to(int fd) noexcept {
  pollfd asked{fd, POLLIN, 0};
  return ::poll(&asked, 1, 0) > 0 ? asked.revents : short{0};
}

bool StoppableWait::let_block(int fd) noexcept {
  const int flags = fcntl(fd, F_GETFL);
  return flags >= 0 && fcntl(fd, F_SETFL, flags & ~O_NONBLOCK) == 0;
}

}  // namespace ifog
