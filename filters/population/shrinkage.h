// SPDX-License-Identifier: Apache-2.0
// Jointly fitted coefficients, some with a prior: a prior also shifts the coefficients that are correlated.
#pragma once

#include <Eigen/Dense>
#include <span>

#include "filters/population/two_groups.h"

namespace ifog {

struct KnownCoefficient {
  Eigen::Index at = 0;  // index of the coefficient
  bool has = false;     // false: this member does not have the effect; coefficient zero
  TypePrior prior;      // of the members that have it
};

struct JointEstimate {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

// Conditional expectation and covariance for normal estimates and priors, including the error of the type's
// mean. Each index at most once.
JointEstimate shrunk_together(const JointEstimate& own, std::span<const KnownCoefficient> known);

}  // namespace ifog
