// The coherent lines of the records' errors, slow ones as candidates for the fit of block means, fast ones as
// they are.
#pragma once

#include "filters/diagnosis/record/even_grid.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/residual/lines.h"

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
Lines coherent_lines(const std::vector<EvenError>& errors, const BlockGrid& grid, double significance);

FoundEffect line_effect(const SpectralLine& line, double total_variance);

}  // namespace ifog
