// SPDX-License-Identifier: Apache-2.0
// The rates of a sensor at rest as evenly spaced columns, and the noise of a filter for a model from a
// diagnosis.
//
// A diagnosis' noise terms are sufficient only for white noise: lines, such as the dither of a ring laser,
// are in the noise of a sample but not in N. So the noise is fitted to the corrected rate, as in `ifog tune`.
// A filter that the model already has is fitted again: without the correction, a bias that follows
// temperature looks like a fast random walk.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/model_file/model.h"
#include "filters/rest/rest.h"

namespace ifog::tools {

// Fits process and measurement noise of model.filter with its state model (default: random walk). Uses the
// capture's rates minus `added`, and minus the references if available. Existing noise is kept if `added` is
// empty. added: effects that the capture's rates still contain. path: of the capture, for messages. Returns
// one line: what was fitted, or why nothing could be; "" if not needed.
std::string fit_noise_left(Model& model, const Model& added, const CaptureView& capture,
                           const std::string& path);

// Rest from all axes together, including rates that the user did not select.
[[nodiscard]] Rest rest_of(const CaptureView& capture, double period_s);
// The same. Throws std::runtime_error with one line, beginning with path, if the sensor moved most of the
// time.
[[nodiscard]] Rest mostly_at_rest(const CaptureView& capture, double period_s, const std::string& path);

struct RestColumns {
  std::vector<std::vector<double>> rate_radps;  // by axis
  std::size_t left_out = 0;                     // rows beyond `most`
};

// Evenly spaced columns: samples in motion or missing become NaN, so that the filter's step is the period.
// Uses at most `most` rows of the capture.
[[nodiscard]] RestColumns rest_columns(const CaptureView& capture, const Rest& rest, double period_s,
                                       std::size_t most);

}  // namespace ifog::tools
