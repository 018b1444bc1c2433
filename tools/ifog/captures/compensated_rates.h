// SPDX-License-Identifier: Apache-2.0
// What a model leaves of a capture's rates.
#pragma once

#include <vector>

#include "filters/model_file/model.h"
#include "filters/series/samples.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// The rates less the model's effects, by axis, by the code that subtracts them online. Throws
// std::runtime_error with one line: a channel that the capture does not have. Without
// CaptureView::since_power_up_s a warm-up stays.
[[nodiscard]] std::vector<Samples> compensated_rates(const CaptureView& capture, const Model& model);

}  // namespace ifog::tools
