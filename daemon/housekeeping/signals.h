// SPDX-License-Identifier: Apache-2.0
// The signals that the daemon lives by: SIGTERM and SIGINT end it, SIGHUP reloads.
#pragma once

#include <cstdint>

namespace ifog {

// SIGHUP alone, which would end a process that is still reading its configuration: it waits for housekeeping.
void block_reload();
// For the calling thread and all that it makes: they come to wait_for_signal() alone.
void block_signals();
// The next one, 0 when none came until `deadline_ns` of the monotonic clock. However often SIGHUP comes, it hides no end.
[[nodiscard]] int wait_for_signal(std::int64_t deadline_ns);

}  // namespace ifog
