// SPDX-License-Identifier: Apache-2.0
// The noise that the peaks of a power spectrum stand in, and the bins that stand out of it.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

inline constexpr std::size_t kFirstBinOfLines = 16;  // below, slow noise and a line look alike
inline constexpr double kLeastOfLines = 0.6;  // of a line's power that its nearest bin has, between two bins

// Mean noise power around each bin, from medians so that lines do not count; computed at a few hundred
// frequencies, and between them in proportion.
class NoiseFloor {
 public:
  explicit NoiseFloor(std::span<const double> power);

  [[nodiscard]] double operator[](std::size_t bin) const;
  // The same for bins in order; j: where the one before was found, 0 at first.
  [[nodiscard]] double following(std::size_t bin, std::size_t& j) const;

 private:
  [[nodiscard]] double between(std::size_t j, std::size_t bin) const;

  std::vector<std::size_t> at_;
  std::vector<double> value_;
};

struct SpectralPeaks {
  NoiseFloor floor;
  // Bins no lower than those beside them, in order, whose power over the floor is above kLeastOfLines of what
  // the highest of so many bins of noise reaches: all that any significance asks for.
  struct Peak {
    std::size_t bin;
    double ratio;
  };
  std::vector<Peak> peaks;

  explicit SpectralPeaks(std::span<const double> power);
};

}  // namespace ifog
