// SPDX-License-Identifier: Apache-2.0
// The noise that a filter is given by a diagnosis.
//
// The terms of a diagnosis are what a filter needs only where the noise is white: lines, such as a ring laser's dither,
// are in the noise of a sample and not in N. So the filter's noise is fitted to the corrected rate, as `ifog tune` does
// it. So is that which a model's filter already has: on a sensor whose bias follows a temperature it is a random walk as
// quick as that, by which the corrected rate would be published many times too loud.
#pragma once

#include <string>

#include "filters/model_file/model.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// Fits the driving and measurement noise of model.filter, with its state model (a random walk if it has none), to what
// `added` leaves of the capture's rates, less the references where there are some. Known noise stays as it is where
// `added` is empty. added: effects that the capture's rates still have in them. path: of the capture, for messages.
// Returns what was done, a line, or why nothing could be ("" for nothing to be done).
std::string fit_noise_left(Model& model, const Model& added, const CaptureView& capture,
                           const std::string& path);

}  // namespace ifog::tools
