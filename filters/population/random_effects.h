// SPDX-License-Identifier: Apache-2.0
// Spread of a parameter over a population whose members have individual measurement errors.
#pragma once

#include <cstddef>
#include <span>

namespace ifog {

// Estimate of a parameter from one gyro's captures.
struct Estimate {
  double value = 0.0;
  double std_error = 0.0;  // > 0
};

struct RandomEffects {
  std::size_t count = 0;
  double mean = 0.0, mean_std_error = 0.0;
  double spread = 0.0;     // standard deviation between members, without measurement errors
  double q = 0.0;          // Cochran's Q: chi-square with count - 1 d.o.f. if there is no spread
  double i_squared = 0.0;  // share of the values' variance that is spread (Higgins and Thompson 2002)
};

// Method of moments of DerSimonian and Laird, Controlled Clinical Trials 7 (1986) 177-188: spread from
// Cochran's Q, weights from the sum of both variances. Throws std::invalid_argument: no estimate, or an error
// that is not above zero.
RandomEffects random_effects(std::span<const Estimate> estimates);

}  // namespace ifog
