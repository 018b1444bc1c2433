// Picture of a comparison of rules.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/compare/compare.h"

namespace ifog::tools {

// For each axis the record under the output of the daemon's default rule, and the outputs of all rules by
// themselves in the range they keep to; then the Allan deviation of all outputs of the first axis. Throws as
// plot() does.
void draw_comparison(const std::string& path, const Capture& capture, const Comparison& result,
                     const std::vector<std::string>& rules);

}  // namespace ifog::tools
