// SPDX-License-Identifier: Apache-2.0
// Measurement noise of the regimes, in units of its standard deviation at rest, σ = 1: white, variance 1,
// mean 0 unless stated otherwise.
#pragma once

#include <cstddef>
#include <random>
#include <vector>

namespace ifog::bench {

using Random = std::mt19937_64;

// σ; NaN: missing.
using Noise = std::vector<double>;

Noise gaussian_noise(Random& random, std::size_t samples);
// Student's t with three degrees of freedom: variance 3 before scaling, no fourth moment.
Noise student_noise(Random& random, std::size_t samples);
// Exponential minus its mean: skewness 2.
Noise skewed_noise(Random& random, std::size_t samples);
// Two Gaussians at ±0.9, kurtosis 3 − 2·0.9⁴.
Noise bimodal_noise(Random& random, std::size_t samples);
// Gaussian, each sample missing with probability `share`, independently.
Noise missing_noise(Random& random, std::size_t samples, double share);
// Gaussian, each sample displaced by ±`size` with probability `share`: variance 1 + share·size².
Noise outlier_noise(Random& random, std::size_t samples, double share, double size);
// Gaussian of standard deviation 1; from `from` on `factor` and 1 in turns of `turn` samples, `factor` first.
Noise changing_noise(Random& random, std::size_t samples, std::size_t from, std::size_t turn, double factor);
// AR(1): correlation^k between samples k apart.
Noise coloured_noise(Random& random, std::size_t samples, double correlation);

}  // namespace ifog::bench
