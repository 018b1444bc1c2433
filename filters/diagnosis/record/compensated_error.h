// SPDX-License-Identifier: Apache-2.0
// Residual error of a record after the daemon's correction.
#pragma once

#include "filters/diagnosis/record.h"
#include "filters/model_file/model.h"
#include "filters/series/samples.h"

namespace ifog {

// Rate minus the model's effects minus the reference, if any, by sample. Causal, with lags initialised as
// online. The effects name no axis; a warm_up counts from power-up. Throws as Compensator does.
Samples compensated_error(const Record& record, const Model& model);

}  // namespace ifog
