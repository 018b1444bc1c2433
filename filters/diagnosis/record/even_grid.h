// SPDX-License-Identifier: Apache-2.0
// A record on its nominal grid: even steps, so that spectra and Allan deviations mean something.
#pragma once

#include <optional>
#include <span>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

// values: one a sample of the record. Throws std::invalid_argument when gaps make the grid a hundred times
// the samples.
Samples on_even_grid(const Record& record, double sample_s, std::span<const double> values);

// rate - reference by sample.
Samples error_of(const Record& record);

// Deviation from the mean, without NaN; 0, or nothing, for fewer than two values.
double variance_of(std::span<const double> values);
std::optional<double> variance_of_two(std::span<const double> values);

}  // namespace ifog
