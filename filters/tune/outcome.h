// SPDX-License-Identifier: Apache-2.0
// What the estimator makes of a record with given settings: the published rate against the measured one.
#pragma once

#include <array>
#include <optional>
#include <span>
#include <vector>

#include "filters/settings/filter_settings.h"

namespace ifog {

inline constexpr std::array<double, 4> kOutcomeTaus{0.1, 1.0, 10.0, 100.0};  // s

struct RateFigures {
  double rms_radps = 0.0;  // about the mean
  // Overlapping Allan deviation at kOutcomeTaus; nothing: shorter than a sample or longer than a third of the
  // record.
  std::array<std::optional<double>, kOutcomeTaus.size()> adev_radps{};
};

struct Outcome {
  std::vector<RateFigures> before, after;  // by axis: measured, published
  // By axis: mean square by which the published rate misses the measured one's mean over the next 1, 4, 16 …
  // samples, as long as eight such windows fit. The level is in it: a filter that does not follow misses what
  // comes, as does a filter that follows the noise.
  std::vector<std::vector<double>> ahead;
};

// The estimator runs over all samples, and where nothing was measured there is nothing; the figures are of
// those from `first` on. axes: rad/s, of equal length, NaN where missing, one to three. Throws
// std::invalid_argument for settings that the estimator refuses.
Outcome outcome_of(const FilterSettings& settings, std::span<const std::span<const double>> axes,
                   double period_s, std::size_t first);

}  // namespace ifog
