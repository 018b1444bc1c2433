// SPDX-License-Identifier: Apache-2.0
// Before and after on the part of the records that was kept out of the fit: the model's effects subtracted
// causally, by the code the daemon runs.
#pragma once

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/record/fitted_part.h"

namespace ifog {

// Replaces before and after of the diagnosis, which was made of the fitted share of the records. The
// compensator runs over the whole of each record, so that its lags are settled where the judged part begins.
void judge(const std::vector<Record>& records, const TimeShare& fitted, Diagnosis& diagnosis);

}  // namespace ifog
