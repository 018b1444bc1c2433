// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/stoppable_wait.h"

#include <fcntl.h>
#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>
#include <system_error>

#include "drivers/transport/clock.h"

namespace ifog {

StoppableWait::StoppableWait() : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (event_ < 0)
    throw std::runtime_error("cannot make an eventfd: " + std::generic_category().message(errno));
}

StoppableWait::~StoppableWait() { close(event_); }

void StoppableWait::stop() noexcept {
  const int before = errno;  // a signal handler leaves errno as it was
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
    // Interrupted by a signal: wait for the rest.
  }
}

const short StoppableWait::kReadable = POLLIN;

StoppableWait::Entry StoppableWait::enter_call(std::int64_t until_ns) noexcept {
  ReadAlarm& alarm = ReadAlarm::of_this_thread();
  if (alarm.number() != alarm_.load(std::memory_order_relaxed)) alarm_.store(alarm.number());
  do {
    if (!alarm.is_set(until_ns) && (until_ns <= monotonic_ns() || !alarm.set(until_ns)))
      return Entry::poll_first;
    // After the alarm is set: what stop() rings from now on is not set again.
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
