// SPDX-License-Identifier: Apache-2.0
// Noise of a sensor from its first seconds, for a filter that was told none.
#pragma once

#include <span>

#include "filters/settings/axes.h"

namespace ifog {

struct NoiseEstimate {
  double process_noise = 0.0;      // of a random walk, (rad/s)^2/s
  double measurement_noise = 0.0;  // per sample, (rad/s)^2
  double slow_noise = 0.0;         // R of the white noise that means over many samples have
  Axes walk_share{1.0, 1.0, 1.0};  // of an axis: its own driving noise over process_noise
  bool moved = false;              // more smoothly than any noise: the walk is a motion's
};

// From a record of one or more axes, one after the other in `rates` (axes x n values, rad/s, at dt_s, NaN
// where missing). Axes share one gain, so their variances are averaged; one with fewer than 32 measurements
// is left out, and one that repeats one value where another does not.
//
// Second differences of block means over octaves of block length do not see a constant or a ramp; of each
// octave the median is taken, so motion in a part of the record counts little (in a fifth of it, q comes out
// some five times too large). A random walk of density q in white noise R gives them variance 6 R / m + q dt
// m at m samples a block; R and q are fitted by Gaussian quasi-likelihood to all octaves but the shortest,
// where these are of another kind (octave_fit.h). A record that shows no random walk gets one that it might
// hide; a constant record the noise of its last digit.
// From one octave to the next a motion grows sixteenfold and no noise by more than twice: where that is seen
// the sensor moved, R is what is left of third differences, and the walk is the motion's. A few seconds show
// the white noise well and the random walk badly: `ifog tune` on an hour at rest is the better way. Takes
// about 0.1 ms a thousand values. Allocates. Throws std::invalid_argument when no axis has 32 measurements.
[[nodiscard]] NoiseEstimate estimate_noise(std::span<const double> rates, int axes, double dt_s);

// R of the white noise of one axis, whatever smooth motion there is, by the median of its third differences,
// of four measurements that lie as close to each other as a sixteenth of all do: rate in rad/s, NaN where
// missing; steps: of each the time since the one before it in nominal samples, empty: 1. Infinite with fewer
// than 12 of them. Allocates.
[[nodiscard]] double roughness(std::span<const double> rate, std::span<const double> steps = {});

}  // namespace ifog
