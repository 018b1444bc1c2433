// SPDX-License-Identifier: Apache-2.0
// A recording smoothed: the rate at each sample from all measurements, the later ones too.
//
// Fixed-interval smoothing (Rauch, Tung and Striebel, AIAA Journal 3(8), 1965) of a random walk in white
// noise. How quickly the rate walks is not the same all along: it is what the estimator found, run over the
// record forwards and backwards, so that a manoeuvre is followed from its first sample and not from when it
// was found. The sum of (measured - smoothed) over a record is zero, as a walk has no level of its own: the
// angle is conserved to rounding.
#pragma once

#include <span>
#include <vector>

#include "filters/settings/filter_settings.h"

namespace ifog {

struct Smoothed {
  std::vector<double> rate_radps, variance_rad2ps2;
};

// One axis. rate: rad/s, NaN where missing; walk: variance by which the rate changes from the sample before,
// (rad/s)^2, > 0; noise: R, (rad/s)^2. Allocates. As long as rate; before the first measurement as there.
[[nodiscard]] Smoothed smooth_walk(std::span<const double> rate, std::span<const double> walk, double noise);

// All axes of a record, as long as each other: rates in rad/s with NaN where missing, dt_s the time each
// sample covers. settings: with both noises. Throws std::invalid_argument as Estimator does.
[[nodiscard]] std::vector<Smoothed> smooth(const FilterSettings& settings,
                                           std::span<const std::vector<double>> rates,
                                           std::span<const double> dt_s, double nominal_period_s);

}  // namespace ifog
