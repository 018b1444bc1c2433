// SPDX-License-Identifier: Apache-2.0
// Channels that sense the sensor's motion. Without a reference the rate contains the sensor's rotation, and
// such a channel (seismometer, tilting accelerometer, wheel) would explain rotation as an error. So it may
// not explain anything, except by the mean square of a vibration: rectification is an error, and a rotation
// has no mean square.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

inline constexpr double kStandardGravity = 9.80665;  // m/s^2

// Marks channels that sense motion (FineChannel::moves) if there is no reference rate. Returns sentences
// about what they would explain as rotation. An acceleration that is constant for half a minute at a time is
// left to the search, which limits its size (search/first_reading.h). allowed: nothing is marked.
std::vector<std::string> mark_motion(const std::vector<Record>& records, BlockData& data, bool allowed);

}  // namespace ifog
