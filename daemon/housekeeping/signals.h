// SPDX-License-Identifier: Apache-2.0
// Signals of the daemon: SIGTERM and SIGINT end it, SIGHUP reloads.
#pragma once

#include <cstdint>

namespace ifog {

// Blocks SIGHUP, which would end a process that still reads its configuration, until housekeeping handles it.
void block_reload();
// For the calling thread and its later threads: signals are handled by wait_for_signal() only.
void block_signals();
// Next signal, or 0 at `deadline_ns` of the monotonic clock. SIGHUP never hides an end.
[[nodiscard]] int wait_for_signal(std::int64_t deadline_ns);

}  // namespace ifog
