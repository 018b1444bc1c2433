// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM as a flag that a command checks, so that it can end with its report.
#pragma once

namespace ifog::tools {

// From now on the first SIGINT or SIGTERM interrupts a system call and sets the flag; the second one ends the
// program. SIGPIPE is ignored: a write fails with EPIPE.
void catch_interrupts();

[[nodiscard]] bool interrupted() noexcept;

}  // namespace ifog::tools
