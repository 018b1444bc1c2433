// SPDX-License-Identifier: Apache-2.0
// Detects harmonics of a feedback ramp in the rate: lines at multiples of k cycles per radian turned. Over
// the measured angle they are fixed even if the rate changes; ordinary lines are fixed over time.
#pragma once

#include <optional>
#include <vector>

#include "filters/diagnosis/ramp/phase_table.h"

namespace ifog {

// Part of a record without gaps, with the measured angle.
struct UnbrokenPart {
  Record record;                  // of these samples; empty if there are too few
  std::vector<double> angle_rad;  // since the first sample, from the measured rate

  [[nodiscard]] std::size_t size() const { return angle_rad.size(); }
  [[nodiscard]] double sample_s() const;
  [[nodiscard]] double mean_turn_rad() const;  // mean per sample, signed
  // Adds the phase of a ramp with this number of cycles per radian. The result refers to this object's data.
  [[nodiscard]] PhasedRecord with_phase(double cycles_per_rad) const;
};

// The longest part without gaps, at most 131072 samples; empty below 4096.
UnbrokenPart unbroken_part(const Record& record);

// The same samples with the angle of a constant rate, for comparison.
UnbrokenPart evenly_turned(UnbrokenPart part);

struct RampComb {
  double cycles_per_rad = 0.0;  // positive
  PhaseTable table;
  double tries = 0.0;       // number of distinguishable k
  double over_fixed = 0.0;  // gain of twice the log-likelihood over the best fixed frequency with harmonics
  double over_line = 0.0;   // gain over a single line that follows the angle
};

// nullopt if no comb exceeds the noise, or near zero rate.
std::optional<RampComb> find_ramp_comb(const UnbrokenPart& part);

}  // namespace ifog
