// SPDX-License-Identifier: Apache-2.0
// What is written is judged: the daemon's own correction with the model that the findings make.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/diagnosis/regression/uncertainty.h"

namespace ifog {

// What the effects leave on the mean beside a reference rate, which the model corrects; it is an effect
// `bias` at the end of the diagnosis' effects, too, where it is beyond five times what the noise makes of a
// record's mean. errors: `after` is filled; uncorrected: the mean of what was taken out
// of it that the model does not correct, such as steps.
void name_bias(const BlockGrid& grid, const JointFit& joint, const std::vector<EvenError>& errors,
               double uncorrected, const std::string& axis, Diagnosis& diagnosis);

// Online the measured rate takes the place of the reference, and less all other effects it is the reference
// plus the bias that no effect explains: what depends on the rate is told to count from there. Without it a
// cubic of a bias of 1 °/s costs a rate table four times the error that the fit leaves. errors: `after` is
// filled.
void count_rates_from_the_bias(const std::vector<EvenError>& errors, std::vector<FoundEffect>& effects,
                               bool corrected = false);

// `written` of each error: what the model leaves that add_to_model() makes of the diagnosis' effects and
// ranges, run sample by sample over the record. One error a record. Throws as Compensator does.
void run_written_model(const std::vector<Record>& records, const Diagnosis& diagnosis, double sample_s,
                       std::vector<EvenError>& errors);
// Effects are fitted on means over blocks, and what lies between the blocks' middles was taken for straight:
// of what steps from one sample to the next that is not so. `after` and `held_out` become what the daemon's
// own correction leaves of each sample, but for what it does not correct, and for what other coefficients
// make of it. Of records that have lost ramps, lines or a dead zone before, both stay.
void leave_as_written(std::vector<EvenError>& errors);

// Of the diagnosis' first `candidates` effects that are corrected online, the one whose absence leaves least
// of the error, means of a two-thousandth of the record; none where each makes it smaller.
std::optional<std::size_t> most_harmful_effect(const std::vector<Record>& records, const Diagnosis& diagnosis,
                                               std::size_t candidates, double sample_s,
                                               const std::vector<EvenError>& errors);

}  // namespace ifog
