// SPDX-License-Identifier: Apache-2.0
// The eigenvalues of a transition: by themselves, for they take a compiler seconds.
#pragma once

#include <Eigen/Core>

namespace ifog {

// n of them, of an n × n transition, in no order.
Eigen::VectorXcd poles(const Eigen::MatrixXd& transition);

}  // namespace ifog
