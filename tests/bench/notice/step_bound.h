// SPDX-License-Identifier: Apache-2.0
// Upper limit of any test for the detection of a bias step.
#pragma once

#include <cstddef>
#include <vector>

#include "tests/bench/notice/slow_noise.h"

namespace ifog::bench {

// Signal of a step in the innovations of the exact Kalman filter for this noise, divided by their standard
// deviation: for its first blocks of block_s, after three days.
[[nodiscard]] std::vector<double> left_of_step(const NoiseKind& kind, double step, double block_s,
                                               std::size_t blocks);

// Signal-to-noise ratio of the step, in standard deviations, for a detector that knows the noise, the past,
// and the step's time and size.
[[nodiscard]] double deviations(const std::vector<double>& left);

// Neyman and Pearson: with one false alarm per alarm_every_s, its probability in a look_s is look_s /
// alarm_every_s on average. At most Phi(d - z) of the steps are found, z its normal quantile. The curve is
// concave, so varying the threshold over time gains nothing.
[[nodiscard]] double best_share(double deviations, double look_s, double alarm_every_s);

}  // namespace ifog::bench
