// SPDX-License-Identifier: Apache-2.0
#include "filters/population/random_effects.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ifog {

RandomEffects random_effects(std::span<const Estimate> estimates) {
  if (estimates.empty()) throw std::invalid_argument("a population without members");
  RandomEffects found;
  found.count = estimates.size();
  double sum = 0.0, sum_of_squares = 0.0, weighted = 0.0;
  for (const Estimate& each : estimates) {
    if (!(each.std_error > 0.0)) throw std::invalid_argument("an estimate without an error above zero");
    const double weight = 1.0 / (each.std_error * each.std_error);
    sum += weight;
    sum_of_squares += weight * weight;
    weighted += weight * each.value;
  }
  const double common = weighted / sum;
  for (const Estimate& each : estimates) {
    const double z = (each.value - common) / each.std_error;
    found.q += z * z;
  }
  const double freedom = static_cast<double>(found.count) - 1.0;
  const double scale = sum - sum_of_squares / sum;
  const double variance = scale > 0.0 ? std::max(0.0, (found.q - freedom) / scale) : 0.0;
  found.spread = std::sqrt(variance);
  found.i_squared = found.q > freedom ? (found.q - freedom) / found.q : 0.0;
  sum = 0.0;
  weighted = 0.0;
  for (const Estimate& each : estimates) {
    const double weight = 1.0 / (each.std_error * each.std_error + variance);
    sum += weight;
    weighted += weight * each.value;
  }
  found.mean = weighted / sum;
  found.mean_std_error = std::sqrt(1.0 / sum);
  return found;
}

}  // namespace ifog
