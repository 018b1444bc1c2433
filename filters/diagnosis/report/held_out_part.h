// Before and after on the part of the records that was kept out of the fit: the model's effects subtracted
// causally, by the code the daemon runs.
#pragma once

#include "filters/diagnosis/diagnose.h"

namespace ifog {

// Replaces before and after of the diagnosis. The compensator runs over the whole of each record, so that its
// lags are settled where the judged part begins.
void judge(const std::vector<Record>& records, const DiagnoseOptions& options, Diagnosis& diagnosis);

// The part of each record that is fitted.
std::vector<Record> fitted_part(const std::vector<Record>& records, const DiagnoseOptions& options);

}  // namespace ifog
