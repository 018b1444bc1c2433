// SPDX-License-Identifier: Apache-2.0
// One short run of a whole pipeline with its channels, its status and its log, beset with faults drawn from a
// seed: damaged, doubled, lost, short and impossible frames, a device that goes within a frame and is slow to
// come back, drops of the kernel, a full ring, a network that does not take messages, reloads, stops, the
// wall clock set to and fro, a channel's bus that floods, a log on a full disk.
#pragma once

#include <string>

namespace ifog {

// "" where everything held: the identities at every look, all counts and the published angle as the intact
// frames say, times of day as the clock was set. Else one line for each thing that did not. Sets this
// program's wall clock (wall_clock.h) and its standard error while it runs.
std::string random_faults(unsigned seed);

// What this process holds: file descriptors, and bytes that malloc has given out.
struct Held {
  int descriptors = 0;
  std::size_t bytes = 0;
};
Held held_by_process();

}  // namespace ifog
