// SPDX-License-Identifier: Apache-2.0
// Reconstructs a channel from its sensor's readings. Quantisation and reading noise would spoil the
// regressors: the derivative of whole degrees is a row of spikes. The search uses reconstructed channels; the
// daemon's correction uses the readings.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/diagnosis/record/blocks.h"

namespace ifog {

struct Reconstruction {
  std::vector<double> values;
  bool smooth = false;  // false: the values are the readings
};

// Maximum-likelihood smoothing spline (integrated random walk plus white reading noise, Kalman smoother;
// Wecker and Ansley 1983). A channel is returned unchanged if a random walk is more likely (it jumps or
// jitters) or if its spline is not well above the reading noise. With steps coarser than the changes only the
// changes are used, and the result is within half a step of the reading. values: equidistant, without gaps; read: 0
// where it is between two readings, empty: nowhere.
Reconstruction reconstruct(std::span<const double> values, std::span<const std::uint8_t> read = {});

// True if averages over 4, 16, 64 … readings scatter no more than those of white noise, within 6 standard
// deviations. Then the channel is constant and its low-pass only noise.
bool stands_still(std::span<const double> readings);

// Reconstructs all channels except the reference and those that follow the rotation, by record; sets smooth
// and still.
BlockData with_reconstructed_channels(const BlockData& data);

// Recomputes channels that are the difference of two others.
void rebuild_differences(BlockData& data);

}  // namespace ifog
