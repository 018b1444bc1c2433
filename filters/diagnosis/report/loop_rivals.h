// SPDX-License-Identifier: Apache-2.0
// Loops that this record cannot tell from the effects found: as long as a channel does not turn, a polynomial
// or its rate describes a loop just as well, and fails on the next capture.
#pragma once

#include <string>

#include "filters/diagnosis/report/findings.h"
#include "filters/diagnosis/residual/hysteresis.h"

namespace ifog {

// Adds them to what cannot be told apart and to the other explanations, which widen the predicted heading
// error. model and fits: those of the search's own, reconstructed channels.
void add_loop_rivals(const BlockData& data, const std::vector<LoopFit>& fits, const NoiseShape& shape,
                     const std::string& axis, Findings& findings);

}  // namespace ifog
