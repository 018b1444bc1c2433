// SPDX-License-Identifier: Apache-2.0
// The way up the likelihood of the noise's parameters.
#pragma once

#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// From `shape` to the top beside it: walk and flicker where they are not zero, and down to zero; a
// Gauss-Markov process of its own where there is one; the harmonics when `with_harmonics`, of which those
// that are an angle stay one.
NoiseFit climb(const BlockGrid& grid, const Columns& columns, NoiseShape shape, double precision,
               bool with_harmonics = false);

}  // namespace ifog
