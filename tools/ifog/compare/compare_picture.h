// SPDX-License-Identifier: Apache-2.0
// Picture of a comparison of rules.
#pragma once

#include <string>
#include <vector>

#include "filters/compare/compare.h"
#include "tools/ifog/captures/capture_view.h"

namespace ifog::tools {

// For each axis a row a rule, on shared axes: the denoised rate over time, in the range that the rules keep
// to once they have started, and its Allan deviation over that of the raw rate. Throws as write_picture does.
void draw_comparison(const std::string& path, const CaptureView& capture, const Comparison& result,
                     const std::vector<std::string>& rules);

}  // namespace ifog::tools
