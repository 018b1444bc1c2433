// SPDX-License-Identifier: Apache-2.0
// Columns of a record as means over grid steps.
#pragma once

#include <cstddef>
#include <cstdint>
#include <span>
#include <vector>

#include "filters/diagnosis/record.h"

namespace ifog {

// Step of the record's fine grid that contains sample i.
std::size_t fine_index(const Record& record, std::size_t i, double fine_s);

// First sample of each step of a record's fine grid, and at the end the number of samples.
using StepStarts = std::vector<std::size_t>;
StepStarts step_starts(const Record& record, double fine_s, std::size_t steps);

// True if most readings equal the previous one and most changes are of one size: the resolution is coarser than the
// channel's changes from reading to reading. Values that are not finite are ignored.
bool is_coarse(std::span<const double> readings);

struct StepMeans {
  std::vector<double> means, power;  // power: variance within a step
  std::vector<std::uint8_t> read;    // 0: rows without a value, interpolated between those with one
};

// Means of a column over each step; linear interpolation where there is no value. holds: a switch, which keeps its value
// over rows without one. readings: not means but the last reading of each step, so that a coarse channel keeps its levels.
StepMeans step_means(std::span<const double> values, const StepStarts& starts, bool with_power, bool holds,
                     bool readings = false);

}  // namespace ifog
