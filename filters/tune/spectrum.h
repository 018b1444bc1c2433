// SPDX-License-Identifier: Apache-2.0
// Spectrum of a record for a first fit: squared cosine transform of each axis, averaged over axes and over
// bins that widen with frequency.
//
// The cosine transform makes a random walk's coefficients independent: for n samples of a walk of steps q
// plus white noise R, coefficient k >= 1 has the variance q / (2 - 2 cos w) + R at w = pi k / n (Strang, "The
// discrete cosine transform", SIAM Review 41, 1999). For a stationary process it has approximately the
// density at w (Whittle's likelihood). No taper or difference is needed.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

struct RecordSpectrum {
  static constexpr std::size_t kOrders = 6;  // largest order of ARMA terms
  // One entry per bin.
  std::vector<double> omega;      // rad per sample
  std::vector<double> density;    // mean square; for white noise its variance
  std::vector<double> ordinates;  // number of squares averaged
  std::vector<double> walk;       // density of a random walk with unit steps
  // cos and sin of 1 … kOrders times omega.
  std::array<std::vector<double>, kOrders> cosine, sine;
  std::size_t samples = 0;  // of the transform

  [[nodiscard]] std::size_t bins() const { return omega.size(); }
};

// Axes as in tune(); missing samples are linearly interpolated.
[[nodiscard]] RecordSpectrum spectrum_of(std::span<const std::vector<double>> axes);

}  // namespace ifog
