#include "daemon/pipeline/wakeup.h"

#include <linux/futex.h>
#include <sys/syscall.h>
#include <unistd.h>

namespace ifog {

static_assert(sizeof(std::atomic<std::uint32_t>) == 4 && std::atomic<std::uint32_t>::is_always_lock_free,
              "a futex is a plain 32-bit word");

void Wakeup::wake() noexcept {
  asleep_.exchange(0, std::memory_order_acq_rel);
  syscall(SYS_futex, &asleep_, FUTEX_WAKE_PRIVATE, 1, nullptr, nullptr, 0);
}

void Wakeup::sleep() noexcept {
  // Returns at once when the producer has cleared the word meanwhile.
  syscall(SYS_futex, &asleep_, FUTEX_WAIT_PRIVATE, 1, nullptr, nullptr, 0);
}

}  // namespace ifog
