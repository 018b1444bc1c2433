// SPDX-License-Identifier: Apache-2.0
// True rates of the regimes, in σ of the measurement noise and in samples; zero before sample `from`.
#pragma once

#include <cstddef>
#include <vector>

#include "tests/bench/quality/noise_kinds.h"

namespace ifog::bench {

inline constexpr double kSampleRate_hz = 200.0;

// `slope` a sample up to `until`, then held.
std::vector<double> ramp(std::size_t samples, std::size_t from, std::size_t until, double slope);
// To `size`, back to 0, to −`size`, back: each at once, 7.5 to 12.5 s after the one before.
std::vector<double> steps(Random& random, std::size_t samples, std::size_t from, double size);
// Turns of 10 s to either side in turn and as long a rest between; the edges are raised cosines of 0.25 s.
std::vector<double> turns(std::size_t samples, std::size_t from, double size);
// A sine of that amplitude and random phase, faded in over its first period.
std::vector<double> sway(Random& random, std::size_t samples, std::size_t from, double amplitude,
                         double frequency_hz);
// The same from the first sample on, in full; faded out over the half period before `until`, zero from there.
std::vector<double> sway_that_ends(Random& random, std::size_t samples, std::size_t until, double amplitude,
                                   double frequency_hz);
// Gaussian of that standard deviation, its spectrum flat up to `band_hz`: white noise through a Butterworth
// filter of eighth order, |H|² = 1/(1 + (tan(πf/fs)/tan(πf_c/fs))^16). Faded in over ten seconds.
std::vector<double> random_motion(Random& random, std::size_t samples, std::size_t from, double rms,
                                  double band_hz);

// The same without fading in, and of an angle that is bounded: less its low-pass of one pole at a fiftieth of
// the sample rate, so that below that the rate's spectrum falls with the square of frequency.
std::vector<double> shaking(Random& random, std::size_t samples, double rms, double band_hz);

}  // namespace ifog::bench
