// SPDX-License-Identifier: Apache-2.0
// Compares a model with the axes of a sensor or capture.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/settings/axes.h"

namespace ifog {

// Message if effects that name no axis would be subtracted from each of several axes; else "".
std::string effects_of_no_axis(const Model& model, std::span<const std::string> axes);
// That message, and one line for noise of an axis that is not in `axes`.
std::vector<std::string> remarks_on_axes(const Model& model, std::span<const std::string> axes);

// Noise and walk of each axis relative to the mean of all, which the filter's settings describe. nullopt if
// the model does not give them for every axis.
struct AxisShares {
  std::optional<Axes> noise, walk;
};

// Noise at a sample rate from the model's terms, mean of the axes; nullopt if not given for every axis.
struct NoiseOfAxes {
  std::optional<double> sample;  // N² times the sample rate, (rad/s)^2
  std::optional<double> walk;    // K², (rad/s)^2/s
  AxisShares shares;
};
// measurement_noise: of the model's filter with its colour, (rad/s)^2; 0: not given. If it exceeds twice the terms' noise it
// includes something else, such as dither lines; then all axes get the same share of it.
[[nodiscard]] NoiseOfAxes noise_of_axes(const Model& model, std::span<const std::string> axes,
                                        double sample_rate_hz, double measurement_noise);

}  // namespace ifog
