// SPDX-License-Identifier: Apache-2.0
#include "filters/tune/hidden_walk.h"

#include <algorithm>

namespace ifog {

bool bound_hidden_walk(const RecordObjective& objective, std::vector<double>& theta) {
  constexpr double kAllowed = 0.5;  // of -ln L: one standard deviation
  std::vector<double> low(theta.size()), high(theta.size());
  objective.candidate().bounds(low, high);
  const auto cost = [&](double ln_q) {
    std::vector<double> other = theta;
    other[0] = ln_q;
    return objective(other);
  };
  const double none = cost(low[0]), best = std::min(none, objective(theta));
  if (none > best + kAllowed) return false;
  // Doubles from the optimum upwards, then bisects.
  double inside = theta[0], outside = inside;
  while (outside < high[0]) {
    outside = std::min(inside + 0.7, high[0]);
    if (cost(outside) > best + kAllowed) break;
    inside = outside;
  }
  constexpr double kNear = 0.02;
  while (outside - inside > kNear) {
    const double middle = 0.5 * (inside + outside);
    (cost(middle) > best + kAllowed ? outside : inside) = middle;
  }
  theta[0] = inside;
  return true;
}

}  // namespace ifog
