// SPDX-License-Identifier: Apache-2.0
// What a report says against itself, or against what the model it writes does to the capture it was made of.
#pragma once

#include <string>
#include <vector>

#include "drivers/capture/capture.h"
#include "filters/diagnosis/diagnosis.h"

namespace ifog::undeclared {

// One line each:
// - an RMS that grows by more than a fiftieth with the effects that are claimed, of single samples or of a
//   hundred means or more; of fewer, where the report has no word of it;
// - all unexplained, with effects that explain a third;
// - the RMS of 10 s means of the first capture, corrected by the model as anyone can, a fifth above the
//   promise;
// - a channel said to be dropped that an effect uses.
std::vector<std::string> contradictions(const Diagnosis& diagnosis, const std::vector<Capture>& captures);

}  // namespace ifog::undeclared
