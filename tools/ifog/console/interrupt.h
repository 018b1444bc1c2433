// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM as a flag that a command checks, so that it can end with its report.
#pragma once

#include <csignal>

namespace ifog::tools {

inline volatile std::sig_atomic_t caught_signal = 0;

// From now on the first SIGINT or SIGTERM interrupts a system call and sets the flag; the second one ends the
// program.
inline void catch_interrupts() {
  struct sigaction action {};
  action.sa_handler = [](int) { caught_signal = 1; };
  // No SA_RESTART, so that a blocking call returns. SA_RESETHAND, so that a second signal ends the program.
  action.sa_flags = static_cast<int>(SA_RESETHAND);
  sigaction(SIGINT, &action, nullptr);
  sigaction(SIGTERM, &action, nullptr);
}

[[nodiscard]] inline bool interrupted() noexcept { return caught_signal != 0; }

}  // namespace ifog::tools
