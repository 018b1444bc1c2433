// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/stoppable_wait.h"

#include <poll.h>
#include <sys/timerfd.h>

#include <array>
#include <cerrno>
#include <stdexcept>
#include <system_error>

#include "drivers/transport/clock.h"

namespace ifog {

StoppableWait::StoppableWait() : alarm_(timerfd_create(CLOCK_MONOTONIC, TFD_CLOEXEC | TFD_NONBLOCK)) {
  if (alarm_ < 0)
    throw std::runtime_error("cannot make a timerfd: " + std::generic_category().message(errno));
}

void StoppableWait::stop() noexcept {
  const int before = errno;  // a signal handler must preserve errno
  stopped_.store(true);
  const itimerspec now{{}, {0, 1}};
  timerfd_settime(alarm_, 0, &now, nullptr);
  errno = before;
}

StoppableWait::Wake StoppableWait::wait(int fd, short events, std::int64_t until_ns,
                                        short* happened) noexcept {
  bool is_over = false;
  for (;;) {
    if (alarm_ns_ > until_ns) {
      is_over = until_ns <= monotonic_ns();
      const itimerspec when{{}, {until_ns / 1'000'000'000, until_ns % 1'000'000'000}};
      if (!is_over && timerfd_settime(alarm_, TFD_TIMER_ABSTIME, &when, nullptr) == 0) alarm_ns_ = until_ns;
    }
    // After the alarm is set, so that stop()'s ringing is not lost.
    if (stopped()) return Wake::stopped;
    std::array<pollfd, 2> fds{{{fd, events, 0}, {alarm_, POLLIN, 0}}};
    const int n = poll(fds.data(), fds.size(), is_over ? 0 : -1);
    if (stopped()) return Wake::stopped;
    if (n > 0 && fds[0].revents != 0) {
      if (happened != nullptr) *happened = fds[0].revents;
      return Wake::ready;
    }
    if (is_over) return Wake::timeout;
    if (n > 0) alarm_ns_ = INT64_MAX;  // it has rung, for this deadline or an earlier one
  }
}

bool StoppableWait::is_readable(int fd) noexcept { return wait(fd, POLLIN, 0) == Wake::ready; }

}  // namespace ifog
