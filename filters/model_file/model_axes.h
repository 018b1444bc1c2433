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

// Noise N² and walk K² of each of several axes, relative to the mean of all: a
// filter's own noises are of that. Nothing where the model does not say it of every axis.
struct AxisShares {
  std::optional<Axes> noise, walk;
};
// Squares of N and K, mean over these axes: (rad/s)^2/Hz, (rad/s^2)^2/Hz. Nothing where the model does not
// say it of every axis.
struct AxisNoiseTerms {
  std::optional<double> N, K;
};
[[nodiscard]] AxisNoiseTerms mean_noise_terms(const Model& model, std::span<const std::string> axes);
[[nodiscard]] AxisShares axis_shares(const Model& model, std::span<const std::string> axes);

}  // namespace ifog
