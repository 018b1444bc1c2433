// SPDX-License-Identifier: Apache-2.0
// Searched time constants at their optimum.
#pragma once

#include "filters/diagnosis/regression/design.h"

namespace ifog {

// The time constant of model[at] of greatest likelihood within a factor of 2.5, all coefficients free, the
// noise held; never outside what time_constants() spans by much. `which` is the first or the second one.
void refine(const BlockData& data, const NoiseShape& shape, std::vector<Candidate>& model, std::size_t at,
            double Candidate::*which = &Candidate::time_constant_s);

}  // namespace ifog
