// SPDX-License-Identifier: Apache-2.0
// The error of a record that the daemon's own correction leaves.
#pragma once

#include "filters/diagnosis/record.h"
#include "filters/model_file/model.h"
#include "filters/series/samples.h"

namespace ifog {

// Rate less the model's effects, causally and with their lags settled as they would be online, less the
// reference if there is one; by sample. The model's effects name no axis; a warm_up
// counts from the first sample, as it was fitted. Throws as Compensator does.
Samples compensated_error(const Record& record, const Model& model);

}  // namespace ifog
