// SPDX-License-Identifier: Apache-2.0
// A reference that jumps from one sample to the next, where it was moved by a part of a sample.
#pragma once

#include <cstddef>
#include <span>

#include "filters/series/samples.h"

namespace ifog {

// What lies between samples is known of what changes slowly against them; where a reference jumps, an
// interpolation rings by a tenth of the jump, which in a turn is thousands of times the noise. Such samples
// are made missing, by the reference's fourth difference against the noise of rate less reference and
// against its second one (of what is smooth it is a small part of that), and how many is returned. None where
// they would be a quarter of all: that is how the sensor was moved.
std::size_t leave_out_jumps(Samples& reference, std::span<const double> rate);

}  // namespace ifog
