// SPDX-License-Identifier: Apache-2.0
// Describes the residual in words on which a person can act.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/noise_fit.h"
#include "filters/diagnosis/residual/lines.h"

namespace ifog {

// Describes the longest record's residual, in which peaks are searched (not on a rate table). of_samples: effects
// that were taken out of the samples.
Unexplained describe_rest(const std::vector<Record>& records, const std::vector<EvenError>& errors,
                          const std::vector<FoundEffect>& of_samples, const NoiseFit& noise,
                          const BlockGrid& grid, double significance,
                          const std::vector<NoiseChangeIn>& noise_changes);

// Replaces the description by that of the hysteresis.
void describe_hysteresis(const Hysteresis& loop, Unexplained& found);

}  // namespace ifog
