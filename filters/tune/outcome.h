// SPDX-License-Identifier: Apache-2.0
// Result of the estimator on a record with given settings: published against measured rate.
#pragma once

#include <span>
#include <vector>

#include "filters/allan/deviation.h"
#include "filters/settings/filter_settings.h"

namespace ifog {

inline constexpr const auto& kOutcomeTaus = kReportedTaus;

struct RateFigures {
  double rms_radps = 0.0;  // about the mean
  ReportedDeviations adev_radps;
};

struct Outcome {
  std::vector<RateFigures> before, after;  // by axis: measured, published
  // By axis: mean squared difference between the published rate and the mean of the next 1, 4, 16 …
  // measurements, as long as eight such windows fit. It increases both for a filter that does not follow the
  // level and for one that follows noise.
  std::vector<std::vector<double>> ahead;
};

// Runs the estimator over all samples; missing samples give no output. The figures use samples from `first`
// on. axes: rad/s, of equal length, NaN where missing, one to three. Throws std::invalid_argument for invalid
// settings.
Outcome outcome_of(const FilterSettings& settings, std::span<const std::span<const double>> axes,
                   double period_s, std::size_t first);

}  // namespace ifog
