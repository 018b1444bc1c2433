// SPDX-License-Identifier: Apache-2.0
// What repeats with the angle of a rate table.
#pragma once

#include <vector>

#include "filters/diagnosis/record.h"
#include "filters/series/samples.h"

namespace ifog {

// Cosine and sine of each channel that is an angle, at even steps of period_s as `on_even_grid` has them; NaN
// where a long gap is. None of a channel of which a tenth of the turn is not known.
std::vector<Samples> turns_of(const Record& record, double period_s);

}  // namespace ifog
