// SPDX-License-Identifier: Apache-2.0
#include "drivers/transport/stoppable_wait.h"

#include <poll.h>
#include <sys/eventfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <cerrno>
#include <ctime>
#include <stdexcept>
#include <system_error>

#include "drivers/transport/clock.h"

namespace ifog {

StoppableWait::StoppableWait() : event_(eventfd(0, EFD_CLOEXEC | EFD_NONBLOCK)) {
  if (event_ < 0)
    throw std::runtime_error("cannot make an eventfd: " + std::generic_category().message(errno));
}

void StoppableWait::stop() noexcept {
  const int before = errno;  // a signal handler must preserve errno
  stopped_.store(true, std::memory_order_relaxed);
  const std::uint64_t one = 1;
  [[maybe_unused]] const ssize_t written = write(event_, &one, sizeof one);
  errno = before;
}

StoppableWait::Wake StoppableWait::wait(int fd, short events, std::int64_t until_ns,
                                        short* happened) noexcept {
  for (;;) {
    std::array<pollfd, 2> fds{{{event_, POLLIN, 0}, {fd, events, 0}}};
    const std::int64_t left = std::max<std::int64_t>(0, until_ns - monotonic_ns());
    const timespec span{left / 1'000'000'000, left % 1'000'000'000};
    const int n = ppoll(fds.data(), fds.size(), &span, nullptr);
    if (stopped() || (n > 0 && fds[0].revents != 0)) return Wake::stopped;
    if (happened != nullptr) *happened = fds[1].revents;
    if (n >= 0) return n == 0 ? Wake::timeout : Wake::ready;
    // Interrupted by a signal: waits for the remaining time.
  }
}

}  // namespace ifog
