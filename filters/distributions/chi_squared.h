// SPDX-License-Identifier: Apache-2.0
// χ² distribution with degrees of freedom > 0, not necessarily whole; relative error 1e-10. Wraps Boost.Math,
// whose templates compile slowly.
#pragma once

namespace ifog {

// Quantile: value that is exceeded with probability 1 - p.
[[nodiscard]] double chi_squared_quantile(double p, double degrees);

// Value that is exceeded with probability `chance`, also for very small ones.
[[nodiscard]] double chi_squared_exceeded(double chance, double degrees);

// Probability of exceeding `value`; 1 below 0.
[[nodiscard]] double chi_squared_above(double value, double degrees);

}  // namespace ifog
