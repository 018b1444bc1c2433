// Noise of a sensor from its first seconds, for a filter that was told none.
#pragma once

#include <span>

namespace ifog {

struct NoiseEstimate {
  double process_noise = 0.0;      // of a random walk, (rad/s)^2/s
  double measurement_noise = 0.0;  // per sample, (rad/s)^2
};

// From a record at dt_s, rad/s, NaN where missing. Second differences of block means over octaves of block
// length do not see a constant or a ramp; of each octave the median is taken, so motion in a part of the
// record counts little (in a fifth of it, q comes out some five times too large). A random walk of density q
// in white noise R gives them variance 6 R / m + q dt m at m samples a block; R and q are fitted to all
// octaves by Gaussian quasi-likelihood. A record that shows no random walk gets the slowest one it could have
// shown, q dt = R / n^2; a constant record the noise of its last digit. Throws std::invalid_argument for
// fewer than 32 measurements.
[[nodiscard]] NoiseEstimate estimate_noise(std::span<const double> rate, double dt_s);

}  // namespace ifog
