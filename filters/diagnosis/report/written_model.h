// SPDX-License-Identifier: Apache-2.0
// Validation with the daemon's correction and the model as written.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"
#include "filters/diagnosis/regression/uncertainty.h"
#include "filters/diagnosis/search/search.h"

namespace ifog {

// Sets the bias relative to a reference, which the model corrects: the mean that the corrected effects leave.
// means: from means_of(), zero for effects that are not corrected. The bias is also added as an effect `bias` if
// it exceeds five standard deviations.
void name_bias(const BlockGrid& grid, const JointFit& joint, const Eigen::VectorXd& means,
               const std::string& axis, Diagnosis& diagnosis);

// Fills `written`, `after` and `held_out` of each error with the daemon's correction by the model from
// add_to_model(). found: effects of the search; those not corrected online are also removed from `after`.
// Throws as Compensator does.
void subtract_effects(const std::vector<Record>& records, const BlockData& data, const SearchResult& found,
                      const Diagnosis& diagnosis, std::vector<EvenError>& errors);

// Among the first `candidates` effects, the online-corrected one without which the error is smallest, in
// means over 1/2000 of the record; nullopt if none is corrected.
std::optional<std::size_t> least_missed_effect(const std::vector<Record>& records, const Diagnosis& diagnosis,
                                               std::size_t candidates, double sample_s);

// Time constant of effect `at`, a rate of change, with which the daemon's correction by the readings themselves leaves the
// smallest error: that of the error may be shorter than their noise allows. Tries up to `most_s` by factors of 1.5.
double smoothing_s(const std::vector<Record>& records, const Diagnosis& diagnosis, std::size_t at,
                   double most_s, double sample_s);

}  // namespace ifog
