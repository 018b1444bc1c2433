// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/search/effective_tries.h"

#include <algorithm>
#include <cmath>
#include <numbers>

#include "filters/distributions/chi_squared.h"

namespace ifog {
double tail(double ratio, int columns) {
  if (ratio <= 0.0) return 1.0;
  return chi_squared_above(ratio, columns);
}

double independent_steps(const BlockGrid& grid, const NoiseShape& shape, double ratio) {
  double sum = 0.0;
  for (const BlockRange& record : grid.records) {
    const Eigen::VectorXd h = answer_to_step(grid, shape, record);
    const Eigen::Index length = h.size();
    // A step at a later block answers with the same series, cut short: of lengths n and n - 1.
    double energy = h[0] * h[0];
    double product = 0.0;
    for (Eigen::Index n = 1; n < length; ++n) {
      const double before = energy;
      energy += h[n] * h[n];
      product += h[n] * h[n - 1];
      const double correlation = product / std::sqrt(std::max(before * energy, 1e-300));
      sum += std::min(1.0, std::sqrt(ratio * std::max(0.0, 1.0 - correlation) / std::numbers::pi));
    }
    sum += 1.0;
  }
  return sum;
}

}  // namespace ifog
