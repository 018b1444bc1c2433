// SPDX-License-Identifier: Apache-2.0
// Lines in the spectrum of the error: frequency, amplitude, noise around, and whether amplitude and phase are
// constant over the record. A resonance or a drifting line is a peak, not a line.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

struct SpectralLine {
  double frequency_hz = 0.0;
  double cosine = 0.0, sine = 0.0;  // of 2 pi f t with the record's time t; unit of the error
  double std_error = 0.0;           // of each of them
  double frequency_std_hz = 0.0;
  double ratio = 0.0;      // power / mean of the surrounding noise
  double p_value = 1.0;    // over all frequencies of the record
  double coherence = 0.0;  // 1: constant phase, 0: random; see kCoherent
};

// A line keeps this share of its power if its quarters are added coherently.
inline constexpr double kCoherent = 0.8;

// Peaks with a p-value below `significance` per record, strongest first. Missing samples (NaN) count as the
// mean. error: equidistant with period_s, from start_s.
std::vector<SpectralLine> find_lines(std::span<const double> error, double start_s, double period_s,
                                     double significance, std::size_t most = 12);

// True if two bins of a record's spectrum are too near each other to be found as two peaks.
bool are_one_peak(std::size_t one, std::size_t other);

// Subtracts coherent lines of each record's residual from it and from the grid's block means. Effects `line`, whose
// share is that of the record's variance.
std::vector<FoundEffect> take_out_lines(double significance, BlockGrid& grid, std::vector<EvenError>& errors);

}  // namespace ifog
