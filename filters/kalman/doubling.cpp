// SPDX-License-Identifier: Apache-2.0
#include "filters/kalman/doubling.h"

#include <Eigen/LU>

namespace ifog {
namespace {

FewStatesMatrix symmetric(const FewStatesMatrix& p) { return 0.5 * (p + p.transpose()); }

// (I + a b)^-1 c
FewStatesMatrix solved(const FewStatesMatrix& a, const FewStatesMatrix& b, const FewStatesMatrix& c) {
  FewStatesMatrix sum = a.lazyProduct(b);
  sum.diagonal().array() += 1.0;
  return Eigen::PartialPivLU<FewStatesMatrix>(sum).solve(c);
}

// a + f b f'
FewStatesMatrix carried(const FewStatesMatrix& a, const FewStatesMatrix& f, const FewStatesMatrix& b) {
  const FewStatesMatrix fb = f.lazyProduct(b);
  return a + fb.lazyProduct(f.transpose());
}

}  // namespace

CovarianceDoubling::CovarianceDoubling(const FewStatesMatrix& transition, const FewStatesMatrix& driving,
                                       const FewStatesVector& h, double noise)
    : maps_{{transition, h * h.transpose() / noise, driving}} {}

FewStatesMatrix CovarianceDoubling::ahead(const FewStatesMatrix& p, std::size_t power) {
  while (maps_.size() <= power) maps_.push_back(twice(maps_.back()));
  const Map& map = maps_[power];
  return symmetric(carried(map.h, map.f, solved(p, map.g, p)));
}

CovarianceDoubling::Map CovarianceDoubling::twice(const Map& one) {
  // P -> second(first(P)); both maps are equal, so their order does not matter.
  const FewStatesMatrix back = one.f.transpose();
  return {one.f.lazyProduct(solved(one.h, one.g, one.f)),
          symmetric(carried(one.g, back, solved(one.g, one.h, one.g))),
          symmetric(carried(one.h, one.f, solved(one.h, one.g, one.h)))};
}

}  // namespace ifog
