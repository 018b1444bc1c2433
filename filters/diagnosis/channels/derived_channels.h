// SPDX-License-Identifier: Apache-2.0
// Channels derived from logged ones: differences of like channels (two thermometers on one coil give its
// gradient) and unwrapped angles.
#pragma once

#include <span>
#include <string>

#include "filters/diagnosis/record/owned_records.h"
#include "filters/model_file/channel_names.h"

namespace ifog {

// Period of a channel with a unit of angle: 2 pi (rad), 360 (deg) or 1 (turns), if its values are within one
// turn and wrap by a whole one; else 0.
double angle_period(const std::string& channel, std::span<const double> values);

// Unwraps angles in every record and sets RecordChannel::period.
OwnedRecords with_unwrapped_angles(OwnedRecords given);

// Adds at most six differences of like channels that all records have and that vary, named by
// difference_of().
OwnedRecords with_differences(OwnedRecords given);

}  // namespace ifog
