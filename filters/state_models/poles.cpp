// SPDX-License-Identifier: Apache-2.0
#include "filters/state_models/poles.h"

#include <Eigen/Eigenvalues>

namespace ifog {

Eigen::VectorXcd poles(const Eigen::MatrixXd& transition) {
  return Eigen::EigenSolver<Eigen::MatrixXd>(transition, false).eigenvalues();
}

}  // namespace ifog
