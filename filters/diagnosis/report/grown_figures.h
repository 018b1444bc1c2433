// SPDX-License-Identifier: Apache-2.0
// Figures of a report that are larger after the correction than before it. Over many means that is harm; over
// a few, what the effect had hidden by chance may come to light, and the report says so beside the figure.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/even_error.h"

namespace ifog {

// Whether the RMS of single samples, or of means of which there are a hundred or more, has grown by more than
// a fiftieth. diagnosis: before and after are filled.
bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

// One sentence of the means that have grown over fewer; empty when there are none.
std::string grown_in_words(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

// One sentence where the channels as they were logged, with their faults, leave more than the repaired ones
// the effects were fitted to; empty where they do not. errors: `written` and `logged` are filled.
std::string faults_in_words(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

}  // namespace ifog
