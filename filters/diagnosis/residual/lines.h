// SPDX-License-Identifier: Apache-2.0
// Lines in the spectrum of the error: frequency searched, amplitude against the noise around it, and whether
// one amplitude and phase hold for the whole record. A resonance or a moving line is a peak too, but not a
// line.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/search/search.h"

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

// The coherent lines of the records' errors, slow ones as candidates for the fit of block means, fast ones as
// they are.
struct FastLine {
  std::size_t record;
  SpectralLine line;
};

struct CoherentLines {
  std::vector<Candidate> slow;
  std::vector<FastLine> fast;
};

// Lines in what is left of each record's error.
CoherentLines coherent_lines(const std::vector<EvenError>& errors, const BlockGrid& grid,
                             double significance);

// Keeps the slow lines, which the search was given first, that are still lines once the slow noise and the
// effects are known. samples: of all records.
void keep_proven(const SearchResult& found, std::size_t samples, double significance, CoherentLines& lines);

// Fast lines out of both rests of the errors, for good.
void take_out(const std::vector<FastLine>& lines, double sample_s, std::vector<EvenError>& errors);

}  // namespace ifog
