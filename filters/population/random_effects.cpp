// SPDX-License-Identifier: Apache-2.0
#include "filters/population/random_effects.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>

namespace ifog {

RandomEffects random_effects(std::span<const Estimate> estimates) {
  if (estimates.empty()) throw std::invalid_argument("a population without members");
  Eigen::ArrayXd value(std::ssize(estimates)), own(std::ssize(estimates));
  for (Eigen::Index i = 0; const Estimate& each : estimates) {
    if (!(each.std_error > 0.0)) throw std::invalid_argument("an estimate without an error above zero");
    value[i] = each.value;
    own[i++] = each.std_error * each.std_error;
  }
  RandomEffects found;
  found.count = estimates.size();
  Eigen::ArrayXd weight = own.inverse();
  const double common = (weight * value).sum() / weight.sum();
  found.q = (weight * (value - common).square()).sum();
  const double freedom = static_cast<double>(found.count) - 1.0;
  const double scale = weight.sum() - weight.square().sum() / weight.sum();
  const double variance = scale > 0.0 ? std::max(0.0, (found.q - freedom) / scale) : 0.0;
  found.spread = std::sqrt(variance);
  found.i_squared = found.q > freedom ? (found.q - freedom) / found.q : 0.0;
  weight = (own + variance).inverse();
  found.mean = (weight * value).sum() / weight.sum();
  found.mean_std_error = std::sqrt(1.0 / weight.sum());
  return found;
}

}  // namespace ifog
