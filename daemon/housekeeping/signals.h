// SPDX-License-Identifier: Apache-2.0
// The signals that the daemon lives by: SIGTERM and SIGINT end it, SIGHUP reloads.
#pragma once

#include <cstdint>

namespace ifog {

// SIGHUP alone, which would end a process that is still reading its configuration: it waits for housekeeping.
void block_reload();
// For the calling thread and all that it makes: they come to housekeeping alone, as bytes of a file
// descriptor, and what comes before housekeeping is there waits for it.
void block_signals();

class Signals {
 public:
  // Of blocked ones. Throws std::runtime_error.
  Signals();
  ~Signals();
  Signals(const Signals&) = delete;
  Signals& operator=(const Signals&) = delete;

  // The next signal, 0 when none came until `deadline_ns` of the monotonic clock.
  [[nodiscard]] int wait(std::int64_t deadline_ns) const;

 private:
  int fd_;
};

}  // namespace ifog
