// SPDX-License-Identifier: Apache-2.0
// Figures of a report that are larger after the correction than before it. Over many means that is harm, and
// an effect goes for it; over a few, what the effect had hidden by chance may come to light. No figure grows
// without a word: where nothing is left to go, as on data that were kept back to judge, the report says it.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"

namespace ifog {

// Whether the RMS of single samples or of means has grown by more than a fiftieth where there are a hundred
// or more, and of fewer by more than chance makes of so many. diagnosis: before and after are filled.
bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

// One sentence of the figures that have grown; empty when there are none. samples: that they are of.
std::string grown_in_words(const Diagnosis& diagnosis, double samples);
[[nodiscard]] double samples_of(const std::vector<EvenError>& errors);

// One sentence where the channels as they were logged, with their faults, leave more than the repaired ones
// the effects were fitted to; empty where they do not. errors: `written` and `logged` are filled.
std::string faults_in_words(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

}  // namespace ifog
