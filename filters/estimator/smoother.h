// SPDX-License-Identifier: Apache-2.0
// A recording smoothed: the rate at each sample from all measurements, the later ones too.
//
// Whether an axis rests or moves is what the estimator finds of it, run over the record forwards and
// backwards, so that a motion is known from its first sample and not from when it was found. How quickly it
// moves there the record itself says (motion_pace.h), and with that it is smoothed (motion_smoother.h).
#pragma once

#include <optional>
#include <span>
#include <vector>

#include "filters/estimator/motion_smoother.h"
#include "filters/settings/axes.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

// All axes of a record, as long as each other: rates in rad/s with NaN where missing, dt_s the time each
// sample covers. settings: with both noises; walk_share: of each axis its driving noise over the settings',
// not known: as its noise. Throws std::invalid_argument as Estimator does.
[[nodiscard]] std::vector<Smoothed> smooth(const FilterSettings& settings,
                                           const std::optional<Axes>& walk_share,
                                           std::span<const std::vector<double>> rates,
                                           std::span<const double> dt_s, double nominal_period_s);

}  // namespace ifog
