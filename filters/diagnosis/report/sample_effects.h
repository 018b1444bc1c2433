// SPDX-License-Identifier: Apache-2.0
// Effects that were fitted to samples and not to block means, outside the joint fit: ramps and fast lines.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/residual/record_lines.h"

namespace ifog {

// Ramps first. errors: of the records they were found in.
std::vector<FoundEffect> sample_effects(const std::vector<RampFit>& ramps, const std::vector<FastLine>& lines,
                                        const std::vector<EvenError>& errors, const std::string& axis);

}  // namespace ifog
