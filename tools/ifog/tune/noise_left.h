// SPDX-License-Identifier: Apache-2.0
// The noise that a filter is given, once the rate is corrected by more than when it was fitted.
//
// `ifog tune` on a sensor whose bias follows a temperature finds a random walk as quick as that; a model that
// then corrects the temperature and keeps the walk publishes a rate many times too loud.
#pragma once

#include <string>

#include "filters/model_file/model.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// Fits the driving and measurement noise of model.filter again, with its state model, to what `added`
// leaves of the capture's rates, less the references where there are some. A model that tells its filter no
// noise stays as it is. added: effects that the capture's rates still have in them. path: of the capture, for
// messages. Returns what was done, a line, or why nothing could be ("" for nothing to be done).
std::string fit_noise_left(Model& model, const Model& added, const CaptureView& capture,
                           const std::string& path);

}  // namespace ifog::tools
