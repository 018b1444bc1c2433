// SPDX-License-Identifier: Apache-2.0
// The signals that the daemon lives by: SIGTERM and SIGINT end it, SIGHUP reloads.
#pragma once

#include <cstdint>

namespace ifog {

// SIGHUP alone, which would end a process that is still reading its configuration: it waits for housekeeping.
void block_reload();
// For the calling thread and all that it makes: they come to wait_for_signal() alone.
void block_signals();
// The next signal, 0 when there was none until `deadline_ns` of the monotonic clock. SIGHUP never hides an end.
[[nodiscard]] int wait_for_signal(std::int64_t deadline_ns);

}  // namespace ifog
