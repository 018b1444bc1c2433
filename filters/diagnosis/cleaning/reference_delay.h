// SPDX-License-Identifier: Apache-2.0
// Reference logged late or early relative to the rate. The difference then contains the change of the true
// rate over the delay, which in turns may be the largest part of the record.
#pragma once

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// Shifts the references of all axes by their common delay (cross_delay.h) if it is within ±60 s and certainly not zero.
// Unchanged: records without a reference or a moving one, with an uneven clock, and tables of dwells.
OwnedRecords align_references(OwnedRecords given);

}  // namespace ifog
