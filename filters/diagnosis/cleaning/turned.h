// SPDX-License-Identifier: Apache-2.0
// Records of a sensor that was turned: without a reference its rotation is no error, and no effect, heading
// forecast or noise figure may be made of it.
#pragma once

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// Turned parts become missing, and what is at rest is known; a record with a reference
// stays as given. What is only shaken stays: its means are right.
// Throws std::invalid_argument with one line when a record was turned and less than half of it is at rest.
OwnedRecords without_turns(OwnedRecords given);

}  // namespace ifog
