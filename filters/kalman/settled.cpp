// SPDX-License-Identifier: Apache-2.0
#include "filters/kalman/settled.h"

#include <Eigen/LU>

namespace ifog {

Settled settled(const FewStatesMatrix& transition, const FewStatesVector& h, const FewStatesVector& r,
                const FewStatesVector& gain, const FewStatesMatrix& covariance) noexcept {
  const Eigen::Index n = transition.rows();
  // Coefficient-based products, because Eigen's products of large matrices may allocate.
  const FewStatesMatrix keep = FewStatesMatrix::Identity(n, n) - gain.lazyProduct(h.transpose());
  const FewStatesMatrix f = keep.lazyProduct(transition);
  const Eigen::PartialPivLU<FewStatesMatrix> lu(FewStatesMatrix::Identity(n, n) - f);
  const FewStatesVector once = lu.solve(gain);
  const FewStatesVector moved = f.lazyProduct(once);
  const FewStatesVector twice = lu.solve(moved);
  const FewStatesVector pr = covariance.lazyProduct(r);
  const FewStatesVector summed = lu.solve(pr);
  return {r.dot(twice) / r.dot(once), r.dot(summed) / r.dot(pr)};
}

}  // namespace ifog
