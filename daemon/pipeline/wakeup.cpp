// SPDX-License-Identifier: Apache-2.0
#include "daemon/pipeline/wakeup.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace ifog {

static_assert(sizeof(std::atomic<std::uint32_t>) == 4 && std::atomic<std::uint32_t>::is_always_lock_free,
              "a futex is a plain 32-bit word");

bool Wakeup::change(std::uint32_t from, std::uint32_t to) noexcept {
  return state_.compare_exchange_strong(from, to, std::memory_order_acq_rel, std::memory_order_relaxed);
}

void Wakeup::notify() noexcept {
  for (;;) {
    // Adding zero is a write, and so part of the chain.
    switch (state_.fetch_or(0, std::memory_order_acq_rel)) {
      case kAsleep:
        if (!change(kAsleep, kAwake)) continue;
        wake();
        return;
      case kLent:
        if (!change(kLent, kLentCalled)) continue;
        return;
      default:
        return;
    }
  }
}

bool Wakeup::borrow() noexcept {
  return state_.fetch_or(0, std::memory_order_acq_rel) == kAsleep && change(kAsleep, kLent);
}

void Wakeup::give_back(bool wake_it) noexcept {
  if (!wake_it && change(kLent, kAsleep)) return;
  state_.exchange(kAwake, std::memory_order_acq_rel);
  wake();
}

void Wakeup::wake() noexcept { syscall(SYS_futex, &state_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0); }

void Wakeup::sleep() noexcept {
  // The state changes while the place is lent; the sleeper notices only when it sleeps again.
  for (std::uint32_t now; (now = state_.load(std::memory_order_acquire)) != kAwake;)
    syscall(SYS_futex, &state_, FUTEX_WAIT_PRIVATE, now, nullptr, nullptr, 0);
}

}  // namespace ifog
