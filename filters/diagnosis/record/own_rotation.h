// SPDX-License-Identifier: Apache-2.0
// Channels that tell how the sensor itself is turned. Where it tilts about the axis of its rate, gravity's
// share of a horizontal acceleration changes by g times the angle turned; a motor, a wheel or a track's
// curvature say what turns it. Without a reference rate that rotation stands in the rate, and whatever is
// made of such a channel (a lag of a swing runs like its slope) would take rotation for an error.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// Marks the channels that rotate (FineChannel::rotates), a sentence each or for all. Of accelerations those
// that the angle turned follows, beside the temperatures, for the most part and by a share of what gravity
// gives; what an acceleration does to a bias is in phase with the rate. Of others those that tell motion by
// their names. None where a reference stands beside, nor in a table of dwells.
std::vector<std::string> mark_own_rotation(BlockData& data);

}  // namespace ifog
