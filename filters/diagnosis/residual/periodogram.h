// SPDX-License-Identifier: Apache-2.0
// Periodogram of a series, its noise floor, and its peaks.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

struct Periodogram {
  std::vector<double> power;  // of bins 0 … length / 2, not scaled
  std::size_t length = 0;     // reduced to a product of small primes for the FFT
  double mean = 0.0;          // of all present samples, subtracted first
};

// Largest transform in memory, an hour at 1 kHz; later samples are ignored.
inline constexpr std::size_t kMostTransformed = std::size_t{1} << 22U;

// Missing samples (NaN) count as the mean. Needs at least 16 samples.
Periodogram periodogram(std::span<const double> error);

// Mean noise power around each bin, from medians, so that lines have no influence; interpolated between a few
// hundred frequencies.
class NoiseFloor {
 public:
  explicit NoiseFloor(std::span<const double> power);

  [[nodiscard]] double operator[](std::size_t bin) const;

 private:
  std::vector<std::size_t> at_;
  std::vector<double> value_;
};

// Local maxima above 0.6 times the level that the highest of all noise bins reaches at this significance;
// strongest relative to the floor first.
std::vector<std::size_t> peaks_of(const Periodogram& spectrum, const NoiseFloor& floor, double significance);

struct Spectrum {
  std::vector<double> frequency_hz;
  std::vector<double> density;  // one-sided, unit^2/Hz
};

// Averages in logarithmic bands for drawing, at most `points`.
Spectrum averaged(const Periodogram& spectrum, double period_s, std::size_t points = 600);

}  // namespace ifog
