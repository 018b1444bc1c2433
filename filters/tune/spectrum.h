// SPDX-License-Identifier: Apache-2.0
// What a record's spectrum shows, before any likelihood of the whole record is asked: cosine transform of
// each axis, squared, averaged over axes and over bins that widen with frequency.
//
// The cosine transform, because it makes a random walk's contrasts independent: coefficient k >= 1 of n
// samples of a walk of steps q under white noise R has exactly the variance q / (2 - 2 cos w) + R at w =
// pi k / n (Strang, "The discrete cosine transform", SIAM Review 41, 1999: its vectors are those of the
// second difference with free ends). Of a stationary process it has the density at w, near enough for a first
// fit (Whittle's likelihood); no taper and no difference is needed.
#pragma once

#include <array>
#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

struct RecordSpectrum {
  static constexpr std::size_t kOrders = 6;  // of the largest ARMA part
  // One entry a bin.
  std::vector<double> omega;      // rad a sample
  std::vector<double> density;    // mean square: white noise has its variance everywhere
  std::vector<double> ordinates;  // how many squares that is the mean of
  std::vector<double> walk;       // density of a random walk with steps of unit variance
  // cos and sin of 1 … kOrders times omega.
  std::array<std::vector<double>, kOrders> cosine, sine;
  std::vector<double> coarse;  // the density averaged over neighbours until 16 squares are in it
  std::size_t samples = 0;     // of the transform

  [[nodiscard]] std::size_t bins() const { return omega.size(); }
};

// Axes as in tune(); where samples are missing the gaps are bridged by straight lines.
[[nodiscard]] RecordSpectrum spectrum_of(std::span<const std::vector<double>> axes);

}  // namespace ifog
