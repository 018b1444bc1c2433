// SPDX-License-Identifier: Apache-2.0
// The stretches at rest of a capture as columns for a fit of the noise.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/rest/rest.h"

namespace ifog::tools {

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
