// SPDX-License-Identifier: Apache-2.0
// Finds contradictions within a report, and between a report and the effect of its model on the capture.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/diagnosis/diagnosis.h"

namespace ifog::undeclared {

// One line each: - an RMS that grows by more than 2 % with the claimed effects, of single samples or of 100
// means or more; of fewer means if the report does not mention it; - everything unexplained, although effects
// explain a third; - the RMS of 10 s means of the first capture, corrected by the model, 20 % above the
// promised value; - a channel that is reported as dropped but used by an effect.
std::vector<std::string> contradictions(const Diagnosis& diagnosis, const std::vector<Capture>& captures);

}  // namespace ifog::undeclared
