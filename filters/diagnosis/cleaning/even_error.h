// SPDX-License-Identifier: Apache-2.0
// Error of every record on its nominal grid, and the parts explained so far.
#pragma once

#include <memory>
#include <vector>

#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/series/samples.h"

namespace ifog {

using SharedSamples = std::shared_ptr<const Samples>;

// Error of one record on an equidistant grid, NaN where missing. Series that no step changes are shared.
struct EvenError {
  RecordOrigin origin{};  // of start_s
  double start_s = 0.0;
  SharedSamples before;    // rate - reference
  SharedSamples rest;      // minus lines and dead zone, which are not corrected
  SharedSamples after;     // `rest` minus the effects
  SharedSamples written;   // residual of `before` after the daemon's correction with the written model
  SharedSamples held_out;  // the same with coefficients fitted without the sample's own part
};

// Leaves after, held_out and written null. Throws as on_even_grid() does.
std::vector<EvenError> even_errors(const std::vector<Record>& records, double sample_s);

// Subtracts a part, given by sample, from the record's residual and from its block means in the grid.
void take_out(std::span<const double> part, std::size_t record, BlockGrid& grid, EvenError& error);

// Throws std::invalid_argument if the error is constant over every record: stuck device or placeholder.
void refuse_constant(const std::vector<Record>& records);

}  // namespace ifog
