// SPDX-License-Identifier: Apache-2.0
// The coefficient of a member that has the effect, as its own captures and the population say together: of
// one coefficient, weighted by the inverse variances, in closed form. What shrunk_together() makes of several
// is held against it.
#pragma once

#include "filters/population/two_groups.h"
#include "tests/unit/test.h"

namespace ifog {

inline Estimate shrunk(const TypePrior& prior, const Estimate& estimate) {
  const double own = estimate.std_error * estimate.std_error;
  const double type = prior.spread * prior.spread;
  const double to_mean = own / (own + type);
  const double of_mean = to_mean * prior.mean_std_error;
  return {estimate.value + to_mean * (prior.mean - estimate.value),
          std::sqrt(own * type / (own + type) + of_mean * of_mean)};
}

}  // namespace ifog
