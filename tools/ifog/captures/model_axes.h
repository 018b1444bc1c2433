// SPDX-License-Identifier: Apache-2.0
// Applies a model to the axes of a capture.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/model_file/model.h"
#include "filters/model_file/model_axes.h"
#include "filters/series/samples.h"

namespace ifog::tools {

// Warns on standard error if effects without an axis, from a sensor with one axis, apply to each of several.
// path: of the model.
void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes);

// The model without the effects of dropped axes and those that depend on their rates; prints the latter. The
// rest is unchanged.
[[nodiscard]] Model without_axes(Model model, const std::vector<std::string>& axes);

// Rates minus the model's effects, by axis, with the code that the daemon uses. Throws std::runtime_error
// with one line if the capture lacks a channel. Without CaptureView::since_power_up_s a warm-up is not
// corrected.
[[nodiscard]] std::vector<Samples> compensated_rates(const CaptureView& capture, const Model& model);

}  // namespace ifog::tools
