// SPDX-License-Identifier: Apache-2.0
// Channels that tell how the sensor itself is turned. Where it tilts about the axis of its rate, gravity's
// share of a horizontal acceleration changes by g times the angle turned; in a curve the acceleration across
// is the rate times the speed; a motor, a wheel or a track's curvature say what turns it. Without a reference
// rate that rotation stands in the rate, and whatever is made of such a channel (a lag of a swing runs like
// its slope) would take rotation for an error.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// Marks the channels that rotate (FineChannel::rotates), a sentence each or for all. Of accelerations those
// with which the angle turned, or the rate, changes by more than chance and by more for each m/s^2 than any
// sensor errs; what an acceleration does to a bias is in phase with it, and a thousandth of what a curve
// does. Of others those that tell motion by their names. None where a reference stands beside, nor in a table
// of dwells.
std::vector<std::string> mark_own_rotation(BlockData& data);

}  // namespace ifog
