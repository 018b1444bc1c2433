// SPDX-License-Identifier: Apache-2.0
// A reference that was logged late or early against the rate. The difference of the two is then the true
// rate's change over the delay: no error of the gyro, but where it turns the largest thing in the record.
#pragma once

#include <cstddef>
#include <span>

#include "filters/diagnosis/record/owned_records.h"
#include "filters/series/samples.h"

namespace ifog {

// The delay within 60 s of greatest likelihood, together with a constant and a cubic of the reference, in
// innovations of an autoregressive noise. Sought by generalised cross-correlation (Knapp and Carter 1976:
// both series whitened as the rate demands), then by Gauss and Newton to a part of a sample. Applied where it
// gains more likelihood than the lags tried would by chance, and more than what repeats with an angle that
// was logged; a reference that does not move has nothing to tell it by. Left as they are: records without a
// reference, with an uneven clock, and tables of dwells.
OwnedRecords align_references(OwnedRecords given);

// A reference that jumps from one sample to the next, where it was moved by a part of a sample.
// What lies between samples is known of what changes slowly against them; where a reference jumps, an
// interpolation rings by a tenth of the jump, which in a turn is thousands of times the noise. Such samples
// are made missing, by the reference's fourth difference against the noise of rate less reference and
// against its second one (of what is smooth it is a small part of that), and how many is returned. None where
// they would be a quarter of all: that is how the sensor was moved.
std::size_t leave_out_jumps(Samples& reference, std::span<const double> rate);

// A series on an even grid, moved by a part of a step.
// values at k + steps for every k, by a sinc under a Hann window of 24 steps: white noise stays as white and
// as loud as it was, so that no shift is preferred for being smooth. Linear next to holes; NaN where there
// is nothing to interpolate between.
Samples shifted(std::span<const double> values, double steps);

}  // namespace ifog
