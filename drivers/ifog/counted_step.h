// SPDX-License-Identifier: Apache-2.0
// A frame of a device that counts, and what DeviceCount makes of it.
#pragma once

#include <cstdint>

namespace ifog {

struct CountedFrame {
  std::uint32_t sequence = 0;
  bool clocked = false;         // it has a clock
  std::int64_t time_ns = 0;     // of that, over its wraps
  double grain_s = 0.0;         // to what a single step of it says how much has passed
  std::int64_t arrival_ns = 0;  // on a clock that nobody sets; 0: not known
  double quiet_s = -1.0;        // since any frame came, also one that was left out; negative: not known
  bool reopened = false;        // the device was closed and opened in between
  std::uint64_t digest = 0;     // of its values
};
// What it says of the time since the frame before.
struct CountedStep {
  std::uint64_t samples = 1;  // since the frame before; 0: the same count again, too soon for a round
  double dt_s = 0.0;          // they took; by the device's clock where that agrees
  bool by_clock = false;      // it does
  bool gap = false;
  bool restarted = false;    // counter or clock jumped: it was switched off and on
  bool out_of_turn = false;  // came again, or after one that follows it; all else here says nothing
  bool clock_moved = false;  // the times of arrival have moved against the count, for good
  double late_s = 0.0;       // so much later than the count: held up on its way, as what follows will show
  bool undecided = false;    // whole rounds may have been lost where it began to be late: what follows tells
  bool same_gap = false;     // what is missing belongs to the gap that was told when it began to be late
};

}  // namespace ifog
