// SPDX-License-Identifier: Apache-2.0
// Accelerometers that tell how the sensor itself is turned. Where it tilts about the axis of its rate,
// gravity's share of a horizontal acceleration changes by g times the angle turned. Without a reference rate
// that rotation stands in the rate, and whatever is made of such a channel (a lag of a swing runs like its
// slope) would take rotation for an error.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// Marks the accelerations that rotate (FineChannel::rotates), one sentence each. The angle turned, over times
// from a block up, must change with the acceleration by more than chance, and by more for each m/s^2 than any
// sensor errs; what an acceleration does to a bias is in phase with it and gives no such slope. None where a
// reference stands beside, nor in a table of dwells.
std::vector<std::string> mark_own_rotation(BlockData& data);

}  // namespace ifog
