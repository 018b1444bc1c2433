// SPDX-License-Identifier: Apache-2.0
// A series on an even grid, moved by a part of a step.
#pragma once

#include <span>

#include "filters/series/samples.h"

namespace ifog {

// values at k + steps for every k, by a sinc under a Hann window of 24 steps: white noise stays as white and
// as loud as it was, so that no shift is preferred for being smooth. Beside holes linear; NaN where there is
// nothing to interpolate between.
Samples shifted(std::span<const double> values, double steps);

}  // namespace ifog
