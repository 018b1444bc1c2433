// SPDX-License-Identifier: Apache-2.0
#include "daemon/housekeeping/signals.h"

#include <poll.h>
#include <signal.h>
#include <sys/signalfd.h>
#include <unistd.h>

#include <algorithm>
#include <array>
#include <stdexcept>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

sigset_t ours() {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : {SIGTERM, SIGINT, SIGHUP}) sigaddset(&set, signal);
  return set;
}

}  // namespace

void block_reload() {
  sigset_t set;
  sigemptyset(&set);
  sigaddset(&set, SIGHUP);
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

void block_signals() {
  const sigset_t set = ours();
  pthread_sigmask(SIG_BLOCK, &set, nullptr);
}

Signals::Signals() {
  const sigset_t set = ours();
  fd_ = signalfd(-1, &set, SFD_CLOEXEC | SFD_NONBLOCK);
  if (fd_ < 0) throw std::runtime_error("no signalfd left");
}

Signals::~Signals() { close(fd_); }

int Signals::wait(std::int64_t deadline_ns) const {
  const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - monotonic_ns());
  const timespec timeout{left / 1'000'000'000, left % 1'000'000'000};
  pollfd wanted{fd_, POLLIN, 0};
  if (ppoll(&wanted, 1, &timeout, nullptr) <= 0) return 0;
  // All that are there: SIGHUP comes first, and however often it comes, it must not hide an end.
  std::array<signalfd_siginfo, 4> infos{};
  const ssize_t bytes = read(fd_, infos.data(), sizeof infos);
  int signal = 0;
  for (std::size_t i = 0; bytes > 0 && i < static_cast<std::size_t>(bytes) / sizeof infos[0]; ++i)
    if (signal == 0 || signal == SIGHUP) signal = static_cast<int>(infos[i].ssi_signo);
  return signal;
}

}  // namespace ifog
