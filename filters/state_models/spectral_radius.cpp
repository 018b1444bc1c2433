// SPDX-License-Identifier: Apache-2.0
#include "filters/state_models/spectral_radius.h"

#include <cmath>

namespace ifog {

// Gelfand's formula: the norm of A^m is nearly the radius to the power of m, here 2^50.
double spectral_radius(const Eigen::MatrixXd& transition) {
  Eigen::MatrixXd power = transition;
  double logarithm = 0.0;
  for (double share = 1.0; share > 0x1p-50; share *= 0.5) {
    const double norm = power.norm();
    if (!(norm > 0.0)) return 0.0;
    logarithm += share * std::log(norm);
    power /= norm;
    power = power.lazyProduct(power).eval();
  }
  return std::exp(logarithm);
}

}  // namespace ifog
