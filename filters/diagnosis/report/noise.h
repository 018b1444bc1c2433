// SPDX-License-Identifier: Apache-2.0
// Noise terms of the residual, as all commands report them.
#pragma once

#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Fills `noise`, `noise_error` and `noise_changes`; adds a remark if the record is too short or its noise
// level changes. Dwells are not evenly sampled: then only the regression's white noise is given.
void write_noise(const std::vector<Record>& records, const std::vector<EvenError>& errors,
                 const BlockGrid& grid, const NoiseFit& regression, Diagnosis& diagnosis);

}  // namespace ifog
