// SPDX-License-Identifier: Apache-2.0
// Largest modulus of the poles of a state model, i.e. of the eigenvalues of its transition.
#pragma once

#include <Eigen/Core>

namespace ifog {

// transition: n × n.
double spectral_radius(const Eigen::MatrixXd& transition);

}  // namespace ifog
