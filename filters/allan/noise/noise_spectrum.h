// SPDX-License-Identifier: Apache-2.0
// What a record says about its noise terms, in numbers whose distribution under any mixture of them is known:
//   - bins of spectra of the record at steps of 1, 2, 4, … samples (angle_means.h): sine-windowed segments
//   that overlap by
//     half, which use every sample alike, each less its mean and slope. A bin is gamma distributed about a
//     mean that is linear in the terms' variances, computed from the terms' covariance, leakage and aliasing
//     included;
//   - below 16 cycles a stretch, the cosine transform (DCT-II) of it at the coarsest step: Gaussian with a
//   covariance
//     that is exact, so that what happens once in a record counts for once.
//
// Unlike a difference variance a bin is narrow: a line or a resonance spoils a few bins, which are seen to
// stand out from their neighbours, and dropped.
#pragma once

#include <Eigen/Dense>
#include <array>
#include <memory>
#include <vector>

#include "filters/allan/power_law.h"

namespace ifog {

struct SpectralBin {
  double frequency = 0.0;    // cycles a sample
  TermVariances expected{};  // power for one unit of each term's variance
  double power = 0.0;        // measured
  double degrees = 0.0;      // of freedom
  bool used = true;
};

// The part of one stretch's slowest frequencies that is alike on either side of its middle, or opposite.
struct SlowPart {
  Eigen::VectorXd value;                           // rad/s
  std::array<Eigen::MatrixXd, kTerms> covariance;  // for one unit of each term's variance
  Eigen::VectorXd ramp;  // what a rate that grows by one a sample makes of it; may be zero
  // The cosines that the means of this level were taken of, a column each: for terms of other covariance.
  std::shared_ptr<const Eigen::MatrixXd> cosines;
  int level = 0;
};

struct FrequencyRange {
  double low = 0.0, high = 0.0;  // cycles a sample
};

struct NoiseSpectrum {
  std::vector<SpectralBin> bins;  // ascending in frequency
  std::vector<SlowPart> slow;
  std::vector<FrequencyRange> lines;  // stood out of their neighbours; their bins are not used
};

inline constexpr std::size_t kShortestStretch = 64;  // samples; shorter ones say nothing

// Spectrum of all stretches together. A level takes at most some thousand segments, evenly over the record (more would
// sharpen what is known to a tenth of a per cent), and the slow part is that of the longest stretches.
[[nodiscard]] NoiseSpectrum noise_spectrum(const AngleSum& sum);

// Marks bins that stand out of their neighbours on both sides by more than chance does once in a million, and
// those next to them, as not used; fills `lines`.
void leave_out_lines(NoiseSpectrum& spectrum);

}  // namespace ifog
