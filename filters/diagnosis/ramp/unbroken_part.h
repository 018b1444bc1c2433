// SPDX-License-Identifier: Apache-2.0
// A part of a record without a hole, with the angle that the sensor has measured in it.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/diagnosis/record.h"

namespace ifog {

// As many of each; the first sample has none before it, and its error and angle are zero.
struct UnbrokenPart {
  std::size_t first = 0;  // sample of the record
  double sample_s = 0.0;
  std::vector<double> error_radps;  // rate, less the reference if there is one, less its slow part
  std::vector<double> angle_rad;    // turned since the first sample, by the rate as measured
  [[nodiscard]] std::size_t size() const { return error_radps.size(); }
  [[nodiscard]] double mean_turn_rad() const;  // of a sample, signed
  // Whether a harmonic of k cycles a radian turns by whole cycles from sample to sample, nearly. What it
  // still moves is then the sample's own noise: regressed on that, the rate would explain itself.
  [[nodiscard]] bool stroboscopic(double cycles_per_rad, std::size_t harmonic) const;
};

// The same samples, as if the rate had been its mean all along.
UnbrokenPart evenly_turned(UnbrokenPart part);

// The longest, and of it the first 131072 samples; empty when there are not 4096. The slow part is a mean of
// all samples so far, at last of 512: as the correction online takes it out (see ramp_tracker.h).
UnbrokenPart unbroken_part(const Record& record);

}  // namespace ifog
