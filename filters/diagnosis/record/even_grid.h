// The error of a record on its nominal grid: even steps, so that spectra and Allan deviations mean something.
#pragma once

#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog {

struct EvenError {
  double start_s = 0.0;
  std::vector<double> before;    // rate - reference, NaN where no sample is
  std::vector<double> after;     // less the effects
  std::vector<double> held_out;  // less the effects as fitted without the sample's own part of the record
};

// values: one a sample of the record. Throws std::invalid_argument when gaps make the grid a hundred times
// the samples.
std::vector<double> on_even_grid(const Record& record, double sample_s, const std::vector<double>& values);

// rate - reference by sample.
std::vector<double> error_of(const Record& record);

// About the mean, NaN left out.
double variance_of(std::span<const double> values);

}  // namespace ifog
