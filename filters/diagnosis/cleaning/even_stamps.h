// SPDX-License-Identifier: Apache-2.0
// Time stamps that scatter about the even clock that the samples were taken by.
#pragma once

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// Records whose stamps scatter, by that clock: on their stamps samples would fall on the same step of a grid
// twice and on the next one not at all. The dwells of a rate table, and steps that are uneven in themselves,
// stay as they are stamped.
OwnedRecords with_even_stamps(OwnedRecords given);

}  // namespace ifog
