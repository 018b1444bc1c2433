// SPDX-License-Identifier: Apache-2.0
// What the best of tests can find of a step of the bias, whatever it does.
#pragma once

#include <cstddef>
#include <vector>

#include "tests/bench/notice/slow_noise.h"

namespace ifog::bench {

// The signal that a step leaves in the innovations of the Kalman filter of exactly this noise, on means of
// block_s after three days of them, over their deviation: of its first blocks, one by one.
[[nodiscard]] std::vector<double> left_of_step(const NoiseKind& kind, double step, double block_s,
                                               std::size_t blocks);

// How far the step stands out of the noise, in standard deviations, once these blocks are seen, by who knows
// the noise, all that came before it, its time and its size.
[[nodiscard]] double deviations(const std::vector<double>& left);

// Neyman and Pearson: who may cry wolf once in alarm_every_s does so within a look_s with a probability of
// look_s / alarm_every_s on average, and with that finds at most Phi(d - z) of the steps, z the normal
// quantile of it. The curve is concave, so nothing is won by being careless at one time and careful at
// another.
[[nodiscard]] double best_share(double deviations, double look_s, double alarm_every_s);

}  // namespace ifog::bench
