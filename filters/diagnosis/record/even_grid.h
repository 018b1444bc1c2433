// SPDX-License-Identifier: Apache-2.0
// A record on its nominal equidistant grid, for spectra and Allan deviations.
#pragma once

#include <span>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

// values: one per sample. Throws std::invalid_argument if gaps make the grid a hundred times as long as the
// samples.
Samples on_even_grid(const Record& record, double sample_s, std::span<const double> values);

// rate - reference by sample.
Samples error_of(const Record& record);

// Interpolates missing values linearly in gaps of up to `most` values, not at the ends.
void bridge(std::span<double> values, std::size_t most);

// Variance about the mean, ignoring NaN; of_fewer for fewer than two values.
double variance_of(std::span<const double> values, double of_fewer = 0.0);

}  // namespace ifog
