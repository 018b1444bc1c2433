// SPDX-License-Identifier: Apache-2.0
// The harmonics of a closed loop's feedback ramp in the rate: lines at multiples of k cycles for each radian
// turned. Looked for over the angle that the sensor itself has measured, so that they stand still however the
// rate changes; against lines of fixed frequencies, which stand still over time.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/ramp/phase_table.h"

namespace ifog {

// A part of a record without a hole, with the angle that the sensor has measured in it.
struct UnbrokenPart {
  Record record;                  // of these samples; none where there are too few
  std::vector<double> angle_rad;  // turned since the first sample, by the rate as measured

  [[nodiscard]] std::size_t size() const { return angle_rad.size(); }
  [[nodiscard]] double sample_s() const;
  [[nodiscard]] double mean_turn_rad() const;  // of a sample, signed
  // With the phase of a ramp of so many cycles a radian. It shows what this owns.
  [[nodiscard]] PhasedRecord with_phase(double cycles_per_rad) const;
};

// The longest, and of it the first 131072 samples; empty when there are not 4096.
UnbrokenPart unbroken_part(const Record& record);

// The same samples, as if the rate had been its mean all along.
UnbrokenPart evenly_turned(UnbrokenPart part);

struct RampComb {
  double cycles_per_rad = 0.0;  // positive
  PhaseTable table;
  double tries = 0.0;       // values of k that could have been found
  double over_fixed = 0.0;  // twice the log-likelihood gained over the best fixed frequency and its harmonics
  double over_line = 0.0;   // the same over one line that follows the angle
};

// Nothing where no comb stands out of the noise, or near zero rate.
std::optional<RampComb> find_ramp_comb(const UnbrokenPart& part);

}  // namespace ifog
