// SPDX-License-Identifier: Apache-2.0
// How a parameter is spread over a population whose members each have it measured with an error of its own.
#pragma once

#include <cstddef>
#include <span>

#include "filters/population/estimate.h"

namespace ifog {

struct RandomEffects {
  std::size_t count = 0;
  double mean = 0.0, mean_std_error = 0.0;
  double spread = 0.0;     // standard deviation from member to member, without the errors of measurement
  double q = 0.0;          // Cochran's: chi-square of count - 1 degrees of freedom where there is no spread
  double i_squared = 0.0;  // share of the variance of the values that is spread (Higgins and Thompson 2002)
};

// Method of moments of DerSimonian and Laird, Controlled Clinical Trials 7 (1986) 177-188: the spread is what
// Cochran's Q has beyond its degrees of freedom, the mean is weighted by one over the sum of both variances.
// Throws std::invalid_argument: no estimate, an error that is not above zero.
RandomEffects random_effects(std::span<const Estimate> estimates);

}  // namespace ifog
