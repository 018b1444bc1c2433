// SPDX-License-Identifier: Apache-2.0
// Picture of a comparison of rules.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/compare/compare.h"
#include "tools/ifog/compare/verdict.h"

namespace ifog::tools {

// For each axis: the rate and its Allan deviation, raw and with the best rule, and the deviations of the
// other rules relative to the best. The title is the verdict. Throws as write_picture does.
void draw_comparison(const std::string& path, const CaptureView& capture, const Comparison& result,
                     const std::vector<std::string>& rules, const std::vector<Verdict>& verdicts);

}  // namespace ifog::tools
