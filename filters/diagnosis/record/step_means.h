// SPDX-License-Identifier: Apache-2.0
// A record's columns as means over the steps of a grid.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/diagnosis/record.h"

namespace ifog {

// The step of a record's fine grid that sample i is in.
std::size_t fine_index(const Record& record, std::size_t i, double fine_s);

// The first sample of each step of a record's fine grid, and behind the last step the number of samples.
using StepStarts = std::vector<std::size_t>;
StepStarts step_starts(const Record& record, double fine_s, std::size_t steps);

struct StepMeans {
  std::vector<double> means, power;  // power: of what is within a step, about its mean
};

// Means of a column over each step. Steps without a value hold the last one; linear where the record has no rows.
StepMeans step_means(std::span<const double> values, const StepStarts& starts, bool with_power);

}  // namespace ifog
