// SPDX-License-Identifier: Apache-2.0
// Channels that sense how the sensor is moved. Without a reference rate the sensor's own rotation stands in
// the rate, and any such channel (a seismometer, an accelerometer that tilts, a wheel) explains that rotation
// as readily as an error. So none of them may explain anything; only the mean square of a vibration may,
// because rectification is an error and a rotation has no mean square.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

inline constexpr double kStandardGravity = 9.80665;  // m/s^2

// Marks the channels that sense motion (FineChannel::moves) where there is no reference rate, and returns
// what they would explain, read as rotation, in sentences. An acceleration that stays for half a minute at a
// time is left to the search, which takes it only at a size that makers specify (see search/plausible.h).
// `allowed`: nothing is marked.
std::vector<std::string> mark_motion(const std::vector<Record>& records, BlockData& data, bool allowed);

}  // namespace ifog
