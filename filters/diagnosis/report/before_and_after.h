// SPDX-License-Identifier: Apache-2.0
// Error figures before and after, pooled over the records.
#pragma once

#include <map>
#include <string>
#include <vector>

#include "filters/diagnosis/cleaning/even_error.h"
#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/fitted_part.h"

namespace ifog {

// Fills `before` and `after`. Each figure after is the larger of two: residual of the written model, and
// residual of effects fitted without each sample's own part.
void write_before_and_after(const std::vector<EvenError>& errors, double sample_s, bool with_bias,
                            Diagnosis& diagnosis);

// The shares of effects that oppose each other or slow noise add up to more than is removed. Lowers the
// shares of the first `jointly` effects in proportion to what the unexplained part leaves; the others are
// shares of single samples.
void balance_shares(std::size_t jointly, Diagnosis& diagnosis);

// True if the RMS of samples or of means has increased: by more than 2 % for 100 values or more, else by more
// than chance. The effect that causes it is then dropped. If none can be dropped the report states the
// increase. diagnosis: before and after are filled.
bool grows_over_many(const Diagnosis& diagnosis, const std::vector<EvenError>& errors);

// Sentence on the figures that have increased, or empty. samples: their number.
std::string grown_in_words(const Diagnosis& diagnosis, double samples);
[[nodiscard]] double samples_of(const std::vector<EvenError>& errors);

// Replaces before and after by figures of the part that was not fitted. The model's effects are subtracted by
// the daemon's code over the whole record, so that its lags are settled in that part.
void judge(const std::vector<Record>& records, const TimeShare& fitted, Diagnosis& diagnosis);

}  // namespace ifog
