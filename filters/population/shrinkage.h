// SPDX-License-Identifier: Apache-2.0
// Coefficients that were fitted together, some of which the population knows something of: what it says of
// one moves those that are correlated with it.
#pragma once

#include <Eigen/Dense>
#include <span>

#include "filters/population/two_groups.h"

namespace ifog {

struct KnownCoefficient {
  Eigen::Index at = 0;  // among the coefficients
  bool has = false;     // false: this member does not have the effect, its coefficient is zero
  TypePrior prior;      // of those that have it
};

struct JointEstimate {
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
};

// Normal estimates and normal priors: the conditional expectation and its covariance, with the error of the
// type's mean carried along. Each place at most once.
JointEstimate shrunk_together(const JointEstimate& own, std::span<const KnownCoefficient> known);

}  // namespace ifog
