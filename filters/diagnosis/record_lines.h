// The coherent lines of the records' errors, slow ones as candidates for the fit of block means, fast ones as
// they are.
#pragma once

#include "filters/diagnosis/candidates.h"
#include "filters/diagnosis/even_error.h"
#include "filters/diagnosis/lines.h"

namespace ifog {

struct FastLine {
  std::size_t record;
  SpectralLine line;
};

struct Lines {
  std::vector<Candidate> slow;
  std::vector<FastLine> fast;
};

// Of what is left of each record's error.
Lines coherent_lines(const std::vector<EvenError>& errors, const BlockGrid& grid, double significance);

FoundEffect line_effect(const SpectralLine& line, double total_variance);

}  // namespace ifog
