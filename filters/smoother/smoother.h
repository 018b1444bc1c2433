// SPDX-License-Identifier: Apache-2.0
// A recording smoothed: the rate at each sample from all measurements, the later ones too.
//
// Whether an axis rests or moves is what the estimator finds of it, run over the record forwards and
// backwards, so that a motion is known from its first sample and not from when it was found. The noise is what
// the estimator knows of it at the end. How quickly the rate moves the record itself says (motion_pace.h), and
// with that it is smoothed (motion_smoother.h). Outliers, which the estimator rejects, take no part.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "filters/settings/axes.h"
#include "filters/settings/filter_settings.h"
#include "filters/smoother/motion_smoother.h"

namespace ifog {

// What is known of each axis beside FilterSettings.
struct AxisNoise {
  // Its noise and its driving noise over the settings'. Not known: the former is the same for all axes, the
  // latter in proportion to the noise.
  std::optional<Axes> noise_share, walk_share;
  // The driving noise is not given: the settings' is a first guess, and each axis' is learned at rest.
  bool learn_walk = false;
};

// All axes of a record, as long as each other: rates in rad/s with NaN where missing, dt_s the time each
// sample covers. settings: with both noises. Throws std::invalid_argument as Estimator does,
// std::runtime_error where a long record finds no room on disk.
[[nodiscard]] std::vector<Smoothed> smooth(const FilterSettings& settings, const AxisNoise& noise,
                                           std::span<const std::span<const double>> rates,
                                           std::span<const double> dt_s, double nominal_period_s);

}  // namespace ifog
