// SPDX-License-Identifier: Apache-2.0
// The noise terms of what the effects leave, as every command reports them.
#pragma once

#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// `noise`, `noise_error` and `noise_changes` of the diagnosis; a remark where the record is too short for
// them and where they are of unlike parts. Dwells are no evenly sampled record: there the regression's own
// white noise is all there is.
void write_noise(const std::vector<Record>& records, const std::vector<EvenError>& errors,
                 const BlockGrid& grid, const NoiseFit& regression, Diagnosis& diagnosis);

}  // namespace ifog
