// SPDX-License-Identifier: Apache-2.0
// Smooths a recording: the rate at each sample from all measurements, including later ones.
//
// The estimator runs over the record forwards and backwards to detect rest and motion, so a motion is known
// from its first sample. The noise is the estimator's final estimate. The pace of the motion is determined
// from the record (motion_pace.h) and used for smoothing (motion_smoother.h). Outliers that the estimator
// rejects are ignored.
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "filters/settings/axes.h"
#include "filters/settings/filter_settings.h"
#include "filters/smoother/motion_smoother.h"

namespace ifog {

// Noise of each axis in addition to FilterSettings.
struct AxisNoise {
  // Ratio of the axes' noise and driving noise to the settings'. nullopt: equal noise; driving noise in
  // proportion to the noise.
  std::optional<Axes> noise_share, walk_share;
  // The driving noise is not given: the settings' is a start value, and each axis's is learned at rest.
  bool learn_walk = false;
};

// Smooths all axes of a record, which are equally long. rates: rad/s, NaN if missing; dt_s: time of each
// sample; settings: with both noises. Throws std::invalid_argument as Estimator does, and std::runtime_error
// if a long record does not fit on disk.
[[nodiscard]] std::vector<Smoothed> smooth(const FilterSettings& settings, const AxisNoise& noise,
                                           std::span<const std::span<const double>> rates,
                                           std::span<const double> dt_s, double nominal_period_s);

}  // namespace ifog
