// SPDX-License-Identifier: Apache-2.0
// True rates of the regimes, in σ of the measurement noise and in samples; zero before sample `from`.
#pragma once

#include <cstddef>
#include <vector>

#include "tests/bench/quality/noise_kinds.h"

namespace ifog::bench {

inline constexpr double kSampleRate_hz = 200.0;

// `slope` per sample until `until`, then constant.
std::vector<double> ramp(std::size_t samples, std::size_t from, std::size_t until, double slope);
// Steps to `size`, 0, −`size`, 0, each 7.5 to 12.5 s after the previous one.
std::vector<double> steps(Random& random, std::size_t samples, std::size_t from, double size);
// Turns of 10 s to alternate sides, each followed by 10 s of rest; the edges are raised cosines of 0.25 s.
std::vector<double> turns(std::size_t samples, std::size_t from, double size);
// A sine of that amplitude and random phase, faded in over its first period.
std::vector<double> sway(Random& random, std::size_t samples, std::size_t from, double amplitude,
                         double frequency_hz);
// The same at full amplitude from the first sample; faded out over the half period before `until`, then zero.
std::vector<double> sway_that_ends(Random& random, std::size_t samples, std::size_t until, double amplitude,
                                   double frequency_hz);
// Gaussian of that standard deviation with a flat spectrum up to `band_hz`: white noise through a Butterworth
// filter of eighth order, |H|² = 1/(1 + (tan(πf/fs)/tan(πf_c/fs))^16). Faded in over ten seconds.
std::vector<double> random_motion(Random& random, std::size_t samples, std::size_t from, double rms,
                                  double band_hz);

// The same without fading, with a bounded angle: minus its one-pole low-pass at a fiftieth of the sample
// rate, so that below it the rate's spectrum falls with the square of frequency.
std::vector<double> shaking(Random& random, std::size_t samples, double rms, double band_hz);

}  // namespace ifog::bench
