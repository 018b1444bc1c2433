// SPDX-License-Identifier: Apache-2.0
// Eigenvalues of a transition; a separate file, because they compile slowly.
#pragma once

#include <Eigen/Core>

namespace ifog {

// The n eigenvalues of an n × n transition, in any order.
Eigen::VectorXcd poles(const Eigen::MatrixXd& transition);

}  // namespace ifog
