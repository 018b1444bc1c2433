// SPDX-License-Identifier: Apache-2.0
// Power of a series at the multiples of one over its length, the noise that its peaks stand in, and the bins
// that stand out of it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

struct Periodogram {
  std::vector<double> power;  // of bins 0 … length / 2, not scaled
  std::size_t length = 0;     // cut to a product of small primes for the transform's sake
  double mean = 0.0;          // of all samples present, subtracted first
};

// A transform has room in memory for so many samples, an hour at 1 kHz: what comes behind is not looked at.
inline constexpr std::size_t kMostTransformed = std::size_t{1} << 22U;

// Missing samples (NaN) count as the mean. At least 16 samples.
Periodogram periodogram(std::span<const double> error);

// Mean noise power around each bin, from medians so that lines do not count; computed at a few hundred
// frequencies, and between them in proportion.
class NoiseFloor {
 public:
  explicit NoiseFloor(std::span<const double> power);

  [[nodiscard]] double operator[](std::size_t bin) const;

 private:
  std::vector<std::size_t> at_;
  std::vector<double> value_;
};

// Bins no lower than those next to them whose power over the floor is above six tenths of what the highest
// of all bins of noise reaches at this significance, strongest over it first.
std::vector<std::size_t> peaks_of(const Periodogram& spectrum, const NoiseFloor& floor, double significance);

struct Spectrum {
  std::vector<double> frequency_hz;
  std::vector<double> density;  // one-sided, unit^2/Hz
};

// Averaged in logarithmic bands for drawing, at most `points`.
Spectrum averaged(const Periodogram& spectrum, double period_s, std::size_t points = 600);

}  // namespace ifog
