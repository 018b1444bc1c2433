// SPDX-License-Identifier: Apache-2.0
// A turn of the unit circle a cycle.
#pragma once

#include <cmath>
#include <complex>
#include <numbers>

namespace ifog {

inline std::complex<double> carrier_of(double cycles) {
  return std::polar(1.0, 2.0 * std::numbers::pi * (cycles - std::floor(cycles)));
}

}  // namespace ifog
