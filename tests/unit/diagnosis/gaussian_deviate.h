// SPDX-License-Identifier: Apache-2.0
// Standard normal deviates by their place, so that each sensor that a test makes is the same on every machine
// (Box and Muller, Annals of Mathematical Statistics 29, 1958, over Philox).
#pragma once

#include <cmath>
#include <cstdint>
#include <numbers>

#include "filters/random/philox.h"

namespace ifog {

inline double gaussian_deviate(std::uint32_t counter, std::uint32_t stream, std::uint32_t seed,
                               std::uint32_t test) {
  const PhiloxBlock bits = philox({counter, stream, 0, 0}, {seed, test});
  const double u = (bits[0] + 0.5) / 4294967296.0;
  const double v = (bits[1] + 0.5) / 4294967296.0;
  return std::sqrt(-2.0 * std::log(u)) * std::cos(2.0 * std::numbers::pi * v);
}

}  // namespace ifog
