// SPDX-License-Identifier: Apache-2.0
// Diagnosis of one axis of one sensor: effects that explain its error, the error before and after, effects
// that cannot be distinguished, and what stays unexplained.
//
// All tests use the innovations of the noise model's Kalman filter, so that slow noise is not mistaken for an
// effect of a slow channel. See search/search.h for the search and regression/whitening.h for the filter.
#pragma once

#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record.h"

namespace ifog {

// Throws std::invalid_argument with one line: no record, a fitted part that ends before it begins, spans of
// unequal length, a reference in some records only or of another sign or unit, fewer than 32 usable samples.
Diagnosis diagnose(const std::vector<Record>& records, const DiagnoseOptions& options);

}  // namespace ifog
