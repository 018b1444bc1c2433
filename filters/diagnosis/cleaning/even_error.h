// SPDX-License-Identifier: Apache-2.0
// The error of every record on its nominal grid, and what of it is explained so far.
#pragma once

#include <vector>

#include "filters/diagnosis/record/blocks.h"
#include "filters/diagnosis/record/even_grid.h"
#include "filters/series/finite_sum.h"
#include "filters/series/shared_samples.h"

namespace ifog {

// The error of one record on an even grid, NaN where there is no sample. Series that are equal share their samples.
struct EvenError {
  RecordOrigin origin{};  // that start_s is counted from
  double start_s = 0.0;
  SharedSamples before;    // rate - reference
  SharedSamples rest;      // less lines and a dead zone, which are not corrected
  SharedSamples after;     // `rest` less the effects
  SharedSamples written;   // what the daemon's own correction leaves of `before`, by the model as written
  SharedSamples held_out;  // the same with coefficients fitted without the sample's own part
};

// after, held_out and written: still empty. The records' rates outlive what is made of them. Throws as
// on_even_grid() does.
std::vector<EvenError> even_errors(const std::vector<Record>& records, double sample_s);

// Takes a part, by sample, out of the rest of a record's error and of the means over its blocks of the grid.
void take_out(std::span<const double> part, std::size_t record, BlockGrid& grid, EvenError& error);

// The sum of one series over all records.
FiniteSum sum_of(const std::vector<EvenError>& errors, SharedSamples EvenError::*series);

// The error of the record with the most steps. At least one record is given.
const EvenError& longest_of(const std::vector<EvenError>& errors);

// A stuck device, or a placeholder: rounding would be all there is to explain. Throws std::invalid_argument
// when the error is the same number all along every record.
void refuse_constant(const std::vector<Record>& records);

}  // namespace ifog
