// SPDX-License-Identifier: Apache-2.0
// Prediction covariance of a time-invariant Kalman filter many samples ahead: doubling algorithm of Anderson
// and Moore, "Optimal Filtering", section 6.7. For measurements at every sample; the caller handles missing
// ones.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/state_models/few_states.h"

namespace ifog {

// A step of the Riccati equation, P' = Q + A P (I + G P)^-1 A' with G = h h'/R, and any number of steps have
// the form P' = H + F P (I + G P)^-1 F'. Two such maps can be combined without P. Called a few times per
// record, so it is not specialised by the number of states.
class CovarianceDoubling {
 public:
  // noise: R > 0.
  CovarianceDoubling(const FewStatesMatrix& transition, const FewStatesMatrix& driving,
                     const FewStatesVector& h, double noise);

  // Covariance 2^power samples ahead.
  [[nodiscard]] FewStatesMatrix ahead(const FewStatesMatrix& p, std::size_t power);

 private:
  struct Map {
    FewStatesMatrix f, g, h;
  };
  [[nodiscard]] static Map twice(const Map& one);

  std::vector<Map> maps_;
};

}  // namespace ifog
