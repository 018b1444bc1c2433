// SPDX-License-Identifier: Apache-2.0
#include "filters/population/shrinkage.h"

#include <vector>

#include "filters/linear/normal_equations.h"

namespace ifog {

JointEstimate shrunk_together(const JointEstimate& own, std::span<const KnownCoefficient> known) {
  const auto count = static_cast<Eigen::Index>(known.size());
  if (count == 0) return own;
  std::vector<Eigen::Index> at;
  Eigen::VectorXd expected = Eigen::VectorXd::Zero(count);
  Eigen::VectorXd spread = Eigen::VectorXd::Zero(count), of_mean = Eigen::VectorXd::Zero(count);
  for (Eigen::Index i = 0; i < count; ++i) {
    const KnownCoefficient& each = known[static_cast<std::size_t>(i)];
    at.push_back(each.at);
    if (!each.has) continue;
    expected[i] = each.prior.mean;
    spread[i] = each.prior.spread * each.prior.spread;
    of_mean[i] = each.prior.mean_std_error * each.prior.mean_std_error;
  }
  Eigen::MatrixXd together = own.covariance(at, at);
  together.diagonal() += spread;
  const Eigen::MatrixXd with_all = own.covariance(Eigen::all, at);
  const Eigen::VectorXd missed = expected - own.values(at);
  const Eigen::MatrixXd gain = with_all * NormalEquations(together, missed).inverse();
  JointEstimate out;
  out.values = own.values + gain * missed;
  out.covariance =
      own.covariance - gain * with_all.transpose() + gain * of_mean.asDiagonal() * gain.transpose();
  out.covariance = 0.5 * (out.covariance + out.covariance.transpose()).eval();
  return out;
}

}  // namespace ifog
