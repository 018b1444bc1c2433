// SPDX-License-Identifier: Apache-2.0
// Solves A X = B for a regular matrix by LU decomposition with pivoting. Wraps Eigen, see symmetric.h.
#pragma once

#include <Eigen/Dense>

namespace ifog {

// a: n × n; b: n × k.
Eigen::MatrixXd solved(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace ifog
