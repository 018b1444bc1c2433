// SPDX-License-Identifier: Apache-2.0
// A model next to the axes of a capture that it is to correct, and what it leaves of their rates.
#pragma once

#include <string>
#include <vector>

#include "filters/model_file/model.h"
#include "filters/model_file/model_axes.h"
#include "filters/series/samples.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// Prints on standard error where effects that name no axis, those of a sensor that has one, are subtracted
// from each of several. path: of the model.
void tell_model_of_one_axis(const Model& model, const std::string& path,
                            const std::vector<std::string>& axes);

// The model for a capture from which these axes of its sensor were dropped: less the effects that are of
// them or depend on their rates. What of the others is lost by that is printed; the rest of it stays as it was.
[[nodiscard]] Model without_axes(Model model, const std::vector<std::string>& axes);

// The rates less the model's effects, by axis, by the code that subtracts them online. Throws
// std::runtime_error with one line: a channel that the capture does not have. Without
// CaptureView::since_power_up_s a warm-up stays.
[[nodiscard]] std::vector<Samples> compensated_rates(const CaptureView& capture, const Model& model);

}  // namespace ifog::tools
