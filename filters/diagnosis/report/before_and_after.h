// SPDX-License-Identifier: Apache-2.0
// The figures of the error before and after, pooled over the records.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/known_angles.h"
#include "filters/diagnosis/record/known_series.h"

namespace ifog {

using KnownFigures = KnownOfSeries<std::map<std::string, double>>;

// `before` and `after` of the diagnosis. Each figure after is the larger of two, so that neither promises
// what the other does not keep: what the written model leaves, and what effects leave that were fitted
// without each sample's own part.
void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, KnownFigures& known,
                            KnownAngles& angles, Diagnosis& diagnosis, bool with_bias = false);

// Parts of effects that run against each other, or against slow noise, are together more than they take away.
// Lowers the shares of the first `jointly` effects in proportion, down to what the unexplained leaves; those
// behind are shares of single samples.
void balance_shares(std::size_t jointly, Diagnosis& diagnosis);

}  // namespace ifog
