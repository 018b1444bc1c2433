// SPDX-License-Identifier: Apache-2.0
// The coherent lines of the records' errors, slow ones as candidates for the fit of block means, fast ones as
// they are.
#pragma once

#include <optional>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/residual/lines.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

struct FastLine {
  std::size_t record;
  SpectralLine line;
};

struct Lines {
  std::vector<Candidate> slow;
  std::vector<FastLine> fast;
};

// Lines at a frequency at which something that was recorded has one, or at a multiple of it, are left out:
// they are what the fit leaves of its effect, and what would explain them is not a line.
void leave_out_periodic(const BlockData& data, Lines& lines);

// Of what is left of each record's error.
Lines coherent_lines(const std::vector<EvenError>& errors, const BlockGrid& grid, double significance,
                     KnownPeriodograms& known);

// Of the slow lines, which the search was given first, those that are still lines beside slow noise and
// effects. samples: of all records.
void keep_proven(const SearchResult& found, std::size_t samples, double significance, Lines& lines);

// Fast lines out of both rests of the errors, for good.
void take_out(const std::vector<FastLine>& lines, double sample_s, std::vector<EvenError>& errors);

}  // namespace ifog
