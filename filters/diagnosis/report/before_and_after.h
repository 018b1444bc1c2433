// SPDX-License-Identifier: Apache-2.0
// The figures of the error before and after, pooled over the records.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/fitted_part.h"

namespace ifog {

// `before` and `after` of the diagnosis. Each figure after is the larger of two, so that neither promises
// what the other does not keep: what the written model leaves, and what effects leave that were fitted
// without each sample's own part.
void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, bool with_bias,
                            Diagnosis& diagnosis);

// Parts of effects that run against each other, or against slow noise, are together more than they take away.
// Lowers the shares of the first `jointly` effects in proportion, down to what the unexplained leaves; those
// behind are shares of single samples.
void balance_shares(std::size_t jointly, Diagnosis& diagnosis);

// Figures of a report that are larger after the correction than before it. Over many means that is harm, and
// an effect goes for it; over a few, what the effect had hidden by chance may come to light. No figure grows
// without a word: where nothing is left to go, as on data that were kept back to judge, the report says it.
// Whether the RMS of single samples or of means has grown by more than a fiftieth where there are a hundred
// or more, and of fewer by more than chance makes of so many. diagnosis: before and after are filled.
bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

// One sentence of the figures that have grown; empty when there are none. samples: that they are of.
std::string grown_in_words(const Diagnosis& diagnosis, double samples);
[[nodiscard]] double samples_of(const std::vector<EvenError>& errors);

// Before and after on the part of the records that was kept out of the fit: the model's effects subtracted
// causally, by the code the daemon runs.
// Replaces before and after of the diagnosis, which was made of the fitted share of the records. The
// compensator runs over the whole of each record, so that its lags are settled where the judged part begins.
void judge(const std::vector<Record>& records, const TimeShare& fitted, Diagnosis& diagnosis);

}  // namespace ifog
