// SPDX-License-Identifier: Apache-2.0
// A record on its nominal grid: even steps, so that spectra and Allan deviations mean something.
#pragma once

#include <span>
#include <vector>

#include "filters/diagnosis/record.h"

namespace ifog {

// values: one a sample of the record. Throws std::invalid_argument when gaps make the grid a hundred times
// the samples.
std::vector<double> on_even_grid(const Record& record, double sample_s, const std::vector<double>& values);

// rate - reference by sample.
std::vector<double> error_of(const Record& record);

// About the mean, NaN left out.
double variance_of(std::span<const double> values);

}  // namespace ifog
