// SPDX-License-Identifier: Apache-2.0
// The prediction covariance of a time-invariant Kalman filter many samples ahead: doubling algorithm of
// Anderson and Moore, "Optimal Filtering", section 6.7. Measurements at every sample, missing ones in between
// are the caller's.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/state_models/few_states.h"

namespace ifog {

// One step of the Riccati equation, P' = Q + A P (I + G P)^-1 A' with G = h h'/R, and any number of them is a
// map of the same form P' = H + F P (I + G P)^-1 F'; two such maps in a row are found without knowing P.
// Asked a few times a record: not by the number of states, each of which the compiler would take seconds for.
class CovarianceDoubling {
 public:
  // noise: R > 0.
  CovarianceDoubling(const FewStatesMatrix& transition, const FewStatesMatrix& driving,
                     const FewStatesVector& h, double noise);

  // 2^power samples ahead.
  [[nodiscard]] FewStatesMatrix ahead(const FewStatesMatrix& p, std::size_t power);

 private:
  struct Map {
    FewStatesMatrix f, g, h;
  };
  [[nodiscard]] static Map twice(const Map& one);

  std::vector<Map> maps_;
};

}  // namespace ifog
