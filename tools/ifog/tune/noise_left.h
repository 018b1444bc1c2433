// SPDX-License-Identifier: Apache-2.0
// Fits the noise of a filter for a model from a diagnosis.
//
// A diagnosis' noise terms are sufficient only for white noise: lines, such as the dither of a ring laser,
// are in the noise of a sample but not in N. So the noise is fitted to the corrected rate, as in `ifog tune`.
// A filter that the model already has is fitted again: without the correction, a bias that follows
// temperature looks like a fast random walk.
#pragma once

#include <string>

#include "drivers/capture/capture.h"
#include "filters/model_file/model.h"

namespace ifog::tools {

// Fits process and measurement noise of model.filter with its state model (default: random walk). Uses the
// capture's rates minus `added`, and minus the references if available. Existing noise is kept if `added` is
// empty. added: effects that the capture's rates still contain. path: of the capture, for messages. Returns
// one line: what was fitted, or why nothing could be; "" if not needed.
std::string fit_noise_left(Model& model, const Model& added, const CaptureView& capture,
                           const std::string& path);

}  // namespace ifog::tools
