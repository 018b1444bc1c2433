// SPDX-License-Identifier: Apache-2.0
// Channels that no logger writes and that physics asks for: the difference of two like channels (two
// thermometers on one coil see its gradient), and angles without their wraps.
#pragma once

#include <list>
#include <span>
#include <string>
#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

struct DerivedRecords {
  std::vector<Record> records;
  std::list<Samples> values;           // which new channels' spans show; keep as long as `records`
  std::vector<std::string> remarks{};  // of what was left out, for people
};

// 2 pi, 360 or 1 when the channel is an angle by its unit (rad, deg, turns) that stays within a turn and
// wraps by a whole one; 0 otherwise.
double angle_period(const std::string& channel, std::span<const double> values);

// Components of one vector, as "magnetic_x_uT" and "magnetic_y_uT": names that differ in their axis alone.
bool of_one_vector(const std::string& one, const std::string& other);

// Angles go on where they wrapped, in every record; RecordChannel::period says which they are.
DerivedRecords with_unwrapped_angles(const std::vector<Record>& records);

// Adds, of the channels that all records have and that move, the differences of like ones (at most six),
// named as difference_of() does.
DerivedRecords with_differences(const std::vector<Record>& records);

}  // namespace ifog
