// SPDX-License-Identifier: Apache-2.0
// What a channel was, from what its sensor read. Readings come in steps and with noise of their own, and a
// regressor made of them is wrong by just that: a derivative of whole degrees is a row of spikes, and what
// such a regressor misses another form picks up. The search therefore looks at reconstructed channels; what
// the daemon will subtract is made of the readings.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

struct Reconstruction {
  std::vector<double> values;
  bool smooth = false;  // otherwise the values are the readings
};

// readings: at even steps, without gaps. The smoothing spline of greatest likelihood (integrated random walk
// plus white reading noise, Kalman smoother; Wecker and Ansley 1983), where that is more likely than a random
// walk: a channel that jumps or jitters is returned as it was. A channel read in steps coarser than its
// changes is measured only where the reading changes, and stays within half a step of the reading. One whose
// spline is not well above the reading noise is returned as it was, too.
Reconstruction reconstruct(std::span<const double> values);

// Whether averages over 4, 16, 64 … readings scatter no more than those of white noise would, within 6
// standard deviations: the channel stood still, and a low-pass of it is a picture of noise alone.
bool stands_still(std::span<const double> readings);

// All channels but the reference and those that follow the rotation, record by record; says which are smooth
// and which stand still.
BlockData with_reconstructed_channels(const BlockData& data);

// Recomputes channels that are the difference of two others from those.
void rebuild_differences(BlockData& data);

}  // namespace ifog
