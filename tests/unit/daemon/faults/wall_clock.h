// SPDX-License-Identifier: Apache-2.0
// The wall clock of this program, set as `date -s` does it, for this program alone. The program must be
// linked with --wrap=clock_gettime.
#pragma once

#include <cstdint>

namespace ifog {

// CLOCK_REALTIME is the system's plus this from now on. Any thread.
void set_wall_clock(std::int64_t offset_ns) noexcept;

}  // namespace ifog
