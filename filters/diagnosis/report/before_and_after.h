// SPDX-License-Identifier: Apache-2.0
// The figures of the error before and after, pooled over the records.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/even_error.h"
#include "filters/diagnosis/record/known_angles.h"
#include "filters/diagnosis/record/known_series.h"

namespace ifog {

using KnownFigures = KnownOfSeries<std::map<std::string, double>>;

// `before` and `after` of the diagnosis. Each figure after is the larger of two, so that neither promises
// what the other does not keep: what the written model leaves, and what effects leave that were fitted
// without each sample's own part.
void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, KnownFigures& known,
                            KnownAngles& angles, Diagnosis& diagnosis);

}  // namespace ifog
