// SPDX-License-Identifier: Apache-2.0
// Blocks in which a channel was stuck. What it did there is not known, and a straight line in its place would
// make steps of the bias, or another coefficient, of what it did.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/channel_faults.h"

namespace ifog {

// Makes those blocks of the grid invalid in which one of the channels, or the difference it is part of, was
// stuck; a stretch of more than a quarter of its record stays. A sentence for each stretch that took a valid
// block away; none, and nothing done, of a rate table's dwells.
std::vector<std::string> leave_out_stuck(const std::vector<StuckStretch>& stuck,
                                         const std::vector<std::string>& channels, BlockGrid& grid);

}  // namespace ifog
