// SPDX-License-Identifier: Apache-2.0
// Reference logged late or early relative to the rate. The difference then contains the change of the true
// rate over the delay, which in turns may be the largest part of the record.
#pragma once

#include <cstddef>
#include <span>

#include "filters/diagnosis/record/owned_records.h"
#include "filters/series/samples.h"

namespace ifog {

// Shifts references by the most likely delay within ±60 s, fitted with a constant and a cubic of the
// reference under autoregressive noise. Search by generalised cross-correlation (Knapp and Carter 1976), then
// Gauss-Newton to a fraction of a sample. Applied only if its gain exceeds chance and that of a logged
// angle's harmonics. Unchanged: records without a reference or a moving one, with an uneven clock, and tables
// of dwells.
OwnedRecords align_references(OwnedRecords given);

// Sets to missing the samples where an interpolated reference jumps and returns their number. Interpolation
// rings by a tenth of a jump, which in a turn is far above the noise. Test: the reference's fourth difference
// against the noise of rate minus reference and against its second difference. If a quarter of all samples
// jump, none is removed, because that is the motion.
std::size_t leave_out_jumps(Samples& reference, std::span<const double> rate);

// Series shifted by a fraction of a step: values at k + steps, by a sinc with a Hann window of 24 steps.
// White noise keeps its variance, so no shift is preferred for smoothing. Linear next to gaps; NaN where
// nothing can be interpolated.
Samples shifted(std::span<const double> values, double steps);

}  // namespace ifog
