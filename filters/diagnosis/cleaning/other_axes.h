// SPDX-License-Identifier: Apache-2.0
// The rates of the sensor's other axes, as a channel of this one.
#pragma once

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// Where every record has a reference that moves: without one, what two axes have in common is rotation, and a
// correction must not take it away. An axis that has a reference of its own comes as the daemon has it, less
// its own misalignment and scale factor error: what this one is told to see of it is the true rate's. With
// the measured ones three misaligned axes would be left with the square of their angles.
OwnedRecords with_other_axes(OwnedRecords given);

}  // namespace ifog
