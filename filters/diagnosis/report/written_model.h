// SPDX-License-Identifier: Apache-2.0
// What is written is judged: the daemon's own correction with the model that the findings make.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// The bias compared with a reference rate, which the model corrects: `value` is what the effects that it corrects
// leave on the mean. It is an effect `bias` at the end of the diagnosis' effects, too, where it is beyond
// five times what the noise makes of a record's mean.
void name_bias(const BlockGrid& grid, const JointFit& joint, double value, const std::string& axis,
               Diagnosis& diagnosis);

// `written`, `after` and `held_out` of each error, by the daemon's own correction with the model that
// add_to_model() makes of the diagnosis, run sample by sample over its record. found: the effects among those
// of the diagnosis that were searched; what of them is not corrected online is out of `after`, too. Throws as
// Compensator does.
void subtract_effects(const std::vector<Record>& records, const BlockData& data, const SearchResult& found,
                      const Diagnosis& diagnosis, std::vector<EvenError>& errors);

// Among the diagnosis' first `candidates` effects, the online-corrected one whose absence leaves least error, in
// means over a two-thousandth of the record; none if none is corrected.
std::optional<std::size_t> least_missed_effect(const std::vector<Record>& records, const Diagnosis& diagnosis,
                                               std::size_t candidates, double sample_s);

}  // namespace ifog
