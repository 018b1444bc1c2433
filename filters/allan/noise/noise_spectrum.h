// SPDX-License-Identifier: Apache-2.0
// Spectral data of a record whose distribution is known for any mixture of noise terms:
//   - bins of spectra at steps of 1, 2, 4, … samples (angle_means.h): sine-windowed segments with half
//   overlap, each minus its mean and slope. A bin is gamma distributed. Its mean is linear in the terms' variances
//   and includes leakage and aliasing;
//   - below 16 cycles per stretch, the cosine transform (DCT-II) at the coarsest step, with exact variances. An event
//   that happens once in a record counts once.
//
// A line or a resonance affects only few bins. They are detected and dropped.
#pragma once

#include <vector>

#include "filters/allan/power_law.h"

namespace ifog {

struct SpectralBin {
  double frequency = 0.0;    // cycles per sample
  TermVariances expected{};  // power for one unit of each term's variance
  double power = 0.0;        // measured
  double degrees = 0.0;      // of freedom
  bool used = true;
};

// Cosine of a whole stretch: Gaussian. White noise and random walks make different cosines independent, and flicker nearly.
struct SlowCosine {
  double frequency = 0.0;    // cycles per sample
  TermVariances expected{};  // its variance for one unit of each term's variance
  double value = 0.0;        // rad/s
  double ramp = 0.0;         // response to a rate that grows by one per sample
};

struct FrequencyRange {
  double low = 0.0, high = 0.0;  // cycles per sample
};

struct NoiseSpectrum {
  std::vector<SpectralBin> bins;  // ascending in frequency
  std::vector<SlowCosine> slow;
  std::vector<FrequencyRange> lines;  // detected lines; their bins are not used
};

inline constexpr std::size_t kShortestStretch = 64;  // in samples

// Spectrum of all stretches together. A level uses at most some thousand segments, spread over the record;
// more would improve the accuracy below 0.1 %. The slow parts are those of the longest stretches.
[[nodiscard]] NoiseSpectrum noise_spectrum(const AngleSum& sum);

// Marks as unused each bin that exceeds its neighbours on both sides beyond chance (1e-6), and the bins next
// to it; fills `lines`.
void leave_out_lines(NoiseSpectrum& spectrum);

}  // namespace ifog
