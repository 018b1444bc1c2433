// SPDX-License-Identifier: Apache-2.0
// Dead zone: a rate below which the sensor outputs only its bias, so the error is minus the rotation. A turn
// crosses it in a few samples. So it is detected in samples, relative to a mean over some seconds, before the
// effects of block means.
#pragma once

#include <optional>
#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

// Subtracts the zone's error from the residuals `rest` and from the grid's block means. nullopt, and nothing is
// subtracted, if chance or a single crossing explains it, or if the coefficient, of the crossings too, is not -1 (a scale
// factor, noise of the reference). records: with a reference; its channel is the effect's.
std::optional<FoundEffect> take_out_dead_zone(const std::vector<Record>& records, const std::string& channel,
                                              double significance, BlockGrid& grid,
                                              std::vector<EvenError>& errors);

}  // namespace ifog
