// SPDX-License-Identifier: Apache-2.0
// A model compared with the axes of the sensor, or the capture, that it is to correct.
#pragma once

#include <optional>
#include <span>
#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/settings/axes.h"

namespace ifog {

// Effects that name no axis, those of a sensor that has one, are subtracted from each of several: in words,
// "" where none is.
std::string effects_of_no_axis(const Model& model, std::span<const std::string> axes);
// That, and noise of an axis that a sensor of these has not; a line each.
std::vector<std::string> remarks_on_axes(const Model& model, std::span<const std::string> axes);

// Noise and walk of each of several axes, relative to the mean of all: a filter's own noises are of that. Nothing where the
// model does not say it of every axis.
struct AxisShares {
  std::optional<Axes> noise, walk;
};

// What a model's terms say of the noise at a sample rate, mean over the axes; nothing where it does not say it of
// every axis.
struct NoiseOfAxes {
  std::optional<double> sample;  // N² times the sample rate, (rad/s)^2
  std::optional<double> walk;    // K², (rad/s)^2/s
  AxisShares shares;
};
// measurement_noise: of the model's filter, (rad/s)^2; 0: not given. Where that is above twice what the terms say, it is
// of something they do not know, such as the lines of a dither: all axes get the same share of it.
[[nodiscard]] NoiseOfAxes noise_of_axes(const Model& model, std::span<const std::string> axes,
                                        double sample_rate_hz, double measurement_noise);

}  // namespace ifog
