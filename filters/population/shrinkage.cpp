// SPDX-License-Identifier: Apache-2.0
#include "filters/population/shrinkage.h"

#include "filters/linear/normal_equations.h"

namespace ifog {

JointEstimate shrunk_together(const JointEstimate& own, std::span<const KnownCoefficient> known) {
  const auto count = static_cast<Eigen::Index>(known.size());
  if (count == 0) return own;
  const Eigen::Index size = own.values.size();
  Eigen::MatrixXd picks = Eigen::MatrixXd::Zero(count, size);
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(count), of_mean = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const KnownCoefficient& each = known[static_cast<std::size_t>(i)];
    picks(i, each.at) = 1.0;
    if (!each.has) continue;
    expected[i] = each.prior.mean;
    spread[i] = each.prior.spread * each.prior.spread;
    of_mean[i] = each.prior.mean_std_error * each.prior.mean_std_error;
  }
  Eigen::MatrixXd together = picks * own.covariance * picks.transpose();
  together.diagonal() += spread;
  const NormalEquations weighed(together, expected - picks * own.values);
  const Eigen::MatrixXd gain = own.covariance * picks.transpose() * weighed.inverse();
  JointEstimate out;
  out.values = own.values + gain * (expected - picks * own.values);
  out.covariance =
      own.covariance - gain * picks * own.covariance + gain * of_mean.asDiagonal() * gain.transpose();
  out.covariance = 0.5 * (out.covariance + out.covariance.transpose()).eval();
  return out;
}

}  // namespace ifog
