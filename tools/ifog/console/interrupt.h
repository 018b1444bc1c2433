// SPDX-License-Identifier: Apache-2.0
// SIGINT and SIGTERM as a question that a command asks between two steps, so that it ends with its report.
#pragma once

namespace ifog::tools {

// From here on the first SIGINT or SIGTERM interrupts the system call at hand and is remembered; a second one
// ends the program as usual. SIGPIPE is ignored: a write says EPIPE.
void catch_interrupts();

[[nodiscard]] bool interrupted() noexcept;

}  // namespace ifog::tools
