// SPDX-License-Identifier: Apache-2.0
#pragma once

namespace ifog {

// a + b as the rounded sum and the exact rounding error (Knuth, TAOCP vol. 2, 4.2.2 theorem B).
inline void two_sum(double a, double b, double& sum, double& rest) {
  sum = a + b;
  const double t = sum - a;
  rest = (a - (sum - t)) + (b - t);
}

}  // namespace ifog
