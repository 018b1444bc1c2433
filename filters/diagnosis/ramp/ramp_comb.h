// SPDX-License-Identifier: Apache-2.0
// The harmonics of a closed loop's feedback ramp in the rate: lines at multiples of k cycles for each radian
// turned. Looked for over the angle that the sensor itself has measured, so that they stand still however the
// rate changes; against lines of fixed frequencies, which stand still over time.
#pragma once

#include <complex>
#include <cstddef>
#include <numbers>
#include <optional>

#include "filters/diagnosis/ramp/unbroken_part.h"

namespace ifog {

// A coil of diameter D has D/(n lambda) cycles a radian (Lefevre, The Fiber-Optic Gyroscope, on the phase
// ramp): 2.3 cm at 1.55 um to 70 cm at 0.8 um. What wants another coil is no ramp.
inline constexpr double kLeastCycles = 1e4, kMostCycles = 6e5;
inline constexpr std::size_t kMostHarmonics = 96;

struct RampComb {
  double cycles_per_rad = 0.0;  // positive
  std::size_t harmonics = 0;    // that are worth their two parameters
  double ratio = 0.0;           // twice the log-likelihood they gain
  double over_fixed = 0.0;      // of it, what the best fixed frequency of each harmonic does not gain
  double tries = 0.0;           // values of k that could have been found
};

// Nothing where no comb stands out of the noise, or near zero rate.
std::optional<RampComb> find_ramp_comb(const UnbrokenPart& part);

// A turn of the unit circle a cycle.
inline std::complex<double> carrier_of(double cycles) {
  return std::polar(1.0, 2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
}

}  // namespace ifog
