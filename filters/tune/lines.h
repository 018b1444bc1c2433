// SPDX-License-Identifier: Apache-2.0
// The strongest sinusoid of a record, found and subtracted.
#pragma once

#include <vector>

#include "filters/tune/spectrum.h"

namespace ifog {

// The frequency is the one at which least squares over all axes take out the most, among the peaks of the
// tapered spectrum; each axis has its own amplitude and phase. Axes without missing samples, changed in
// place.
TakenLine take_out_strongest_line(std::vector<std::vector<double>>& axes);

}  // namespace ifog
