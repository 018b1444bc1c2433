// SPDX-License-Identifier: Apache-2.0
#include "daemon/housekeeping/signals.h"

#include <signal.h>

#include <algorithm>
#include <initializer_list>

#include "drivers/transport/clock.h"

namespace ifog {
namespace {

sigset_t set_of(std::initializer_list<int> signals) {
  sigset_t set;
  sigemptyset(&set);
  for (const int signal : signals) sigaddset(&set, signal);
  return set;
}

void block(const sigset_t& set) { pthread_sigmask(SIG_BLOCK, &set, nullptr); }

}  // namespace

void block_reload() { block(set_of({SIGHUP})); }

void block_signals() { block(set_of({SIGTERM, SIGINT, SIGHUP})); }

int wait_for_signal(std::int64_t deadline_ns) {
  const sigset_t ends = set_of({SIGTERM, SIGINT}), all = set_of({SIGTERM, SIGINT, SIGHUP});
  const timespec none{};
  if (const int end = sigtimedwait(&ends, nullptr, &none); end > 0) return end;
  const std::int64_t left = std::max<std::int64_t>(0, deadline_ns - monotonic_ns());
  const timespec timeout{left / 1'000'000'000, left % 1'000'000'000};
  return std::max(0, sigtimedwait(&all, nullptr, &timeout));
}

}  // namespace ifog
