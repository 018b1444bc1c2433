// SPDX-License-Identifier: Apache-2.0
// Lines in the spectrum of the error: frequency searched, amplitude against the noise around it, and whether
// one amplitude and phase hold for the whole record. A resonance or a moving line is a peak too, but not a
// line.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/record/blocks.h"

namespace ifog {

struct SpectralLine {
  double frequency_hz = 0.0;
  double cosine = 0.0, sine = 0.0;  // of 2 pi f t, t the record's time, same unit as the error
  double std_error = 0.0;           // of each of them
  double frequency_std_hz = 0.0;
  double ratio = 0.0;      // power over the mean of the noise around it
  double p_value = 1.0;    // over all frequencies of the record
  double coherence = 0.0;  // 1: one phase all along, 0: none; see kCoherent
  double width_hz = 0.0;   // of the peak, 1 / record length for a line
};

// A line keeps more than this of its power when its quarters are added with their phases.
inline constexpr double kCoherent = 0.8;

// Missing samples (NaN) count as the mean. Peaks above what noise makes once in 1 / significance records,
// strongest first. error: at even steps of period_s, starting at start_s.
std::vector<SpectralLine> find_lines(std::span<const double> error, double start_s, double period_s,
                                     double significance, std::size_t most = 12);

// A line in the error of a record.
struct LineOf {
  std::size_t record;
  SpectralLine line;
};

// Coherent lines in what is left of each record's error, `after`.
std::vector<LineOf> coherent_lines(const std::vector<EvenError>& errors, double sample_s,
                                   double significance);

// Out of the rest of the errors, and of the means over the grid's blocks.
void take_out(const std::vector<LineOf>& lines, BlockGrid& grid, std::vector<EvenError>& errors);

}  // namespace ifog
