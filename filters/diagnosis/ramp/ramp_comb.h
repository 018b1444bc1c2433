// SPDX-License-Identifier: Apache-2.0
// The harmonics of a closed loop's feedback ramp in the rate: lines at multiples of k cycles for each radian
// turned. Looked for over the angle that the sensor itself has measured, so that they stand still however the
// rate changes; against lines of fixed frequencies, which stand still over time.
#pragma once

#include <cstddef>
#include <optional>
#include <vector>

#include "filters/diagnosis/ramp/unbroken_part.h"

namespace ifog {

// A coil of diameter D has D/(n lambda) cycles a radian (Lefevre, The Fiber-Optic Gyroscope, on the phase
// ramp): 2.3 cm at 1.55 um to 70 cm at 0.8 um. What wants another coil is no ramp.
inline constexpr double kLeastCycles = 1e4;
inline constexpr double kMostCycles = 6e5;
inline constexpr std::size_t kMostHarmonics = 96;

struct RampComb {
  double cycles_per_rad = 0.0;  // positive
  std::size_t harmonics = 0;    // that are worth their two parameters
  std::size_t plain = 0;        // of the first sixteen, that stand out of the noise alone
  double ratio = 0.0;           // twice the log-likelihood they gain
  double over_fixed = 0.0;      // of it, what the best fixed frequency of each harmonic does not gain
  double tries = 0.0;           // values of k that could have been found
};

// Nothing where no comb stands out of the noise.
std::optional<RampComb> find_ramp_comb(const UnbrokenPart& part);
// The same of a comb of fixed frequencies, cycles_per_rad at the mean rate; of one plain harmonic or more,
// and of one alone it is no more than a line.
std::optional<RampComb> find_fixed_comb(const UnbrokenPart& part);

// Angle that the mean rate would have turned.
std::vector<double> evenly_turned(const UnbrokenPart& part);

// Cycles a radian that the part can show: from a fundamental above the slow part that was taken out, with
// twenty cycles or more, to one below half the sample rate. Empty (least > most) near zero rate.
struct VisibleCycles {
  double least = 0.0, most = 0.0;
};
VisibleCycles visible_cycles(const UnbrokenPart& part);

}  // namespace ifog
