// SPDX-License-Identifier: Apache-2.0
// The χ² distribution, its degrees > 0 and not necessarily whole; relative error 1e-10. Boost.Math behind
// declarations: the templates of its incomplete gamma function take a compiler as long as most files here.
#pragma once

namespace ifog {

// Value that is exceeded with probability 1 - p.
[[nodiscard]] double chi_squared_quantile(double p, double degrees);

// Value that is exceeded with probability `chance`, which may be too small for 1 - chance to tell.
[[nodiscard]] double chi_squared_exceeded(double chance, double degrees);

// Probability of more than `value` (>= 0).
[[nodiscard]] double chi_squared_above(double value, double degrees);

}  // namespace ifog
