// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/general_solver.h"

namespace ifog {

Eigen::MatrixXd solved(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b) {
  return Eigen::PartialPivLU<Eigen::MatrixXd>(a).solve(b);
}

}  // namespace ifog
