// SPDX-License-Identifier: Apache-2.0
// Channels that no logger writes and that physics asks for: the difference of two like channels (two
// thermometers on one coil see its gradient), and angles without their wraps.
#pragma once

#include <span>
#include <string>

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// 2 pi, 360 or 1 when the channel is an angle by its unit (rad, deg, turns) that stays within a turn and
// wraps by a whole one; 0 otherwise.
double angle_period(const std::string& channel, std::span<const double> values);

// Components of one vector, as "magnetic_x_uT" and "magnetic_y_uT": names that differ in their axis alone.
bool of_one_vector(const std::string& one, const std::string& other);

// Angles go on where they wrapped, in every record; RecordChannel::period says which they are.
OwnedRecords with_unwrapped_angles(OwnedRecords given);

// Adds, of the channels that all records have and that move, the differences of like ones (at most six),
// named as difference_of() does.
OwnedRecords with_differences(OwnedRecords given);

}  // namespace ifog
