// SPDX-License-Identifier: Apache-2.0
// A X = B of any regular matrix, by LU decomposition with pivots. Eigen's: here as what stands in symmetric.h.
#pragma once

#include <Eigen/Dense>

namespace ifog {

// a: n × n; b: n × k.
Eigen::MatrixXd solved(const Eigen::MatrixXd& a, const Eigen::MatrixXd& b);

}  // namespace ifog
