// SPDX-License-Identifier: Apache-2.0
// What of a capture is at rest, in columns as a fit of its noise takes them.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/rest/rest.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// Of all axes together, and of the sensor's rates that the user did not choose.
[[nodiscard]] Rest rest_of(const CaptureView& capture, double period_s);
// The same. Throws std::runtime_error with one line, path in front, where the sensor was mostly
// turned.
[[nodiscard]] Rest mostly_at_rest(const CaptureView& capture, double period_s, const std::string& path);

struct RestColumns {
  std::vector<std::vector<double>> rate_radps;  // by axis
  std::size_t left_out = 0;                     // rows beyond `most`
};

// Evenly spaced: a sample that moved or is missing from the record becomes a NaN, so that the filter's step
// stays the period. Of at most `most` rows of the capture, whatever is missing between them.
[[nodiscard]] RestColumns rest_columns(const CaptureView& capture, const Rest& rest, double period_s,
                                       std::size_t most);

}  // namespace ifog::tools
