// SPDX-License-Identifier: Apache-2.0
// A model beside the axes of the sensor, or the capture, that it is to correct.
#pragma once

#include <span>
#include <string>
#include <vector>

#include "filters/model_file/model.h"

namespace ifog {

// Effects that name no axis, those of a sensor that has one, are subtracted from each of several: in words,
// "" where none is.
std::string effects_of_no_axis(const Model& model, std::span<const std::string> axes);
// That, and noise of an axis that a sensor of these has not; a line each.
std::vector<std::string> remarks_on_axes(const Model& model, std::span<const std::string> axes);

}  // namespace ifog
