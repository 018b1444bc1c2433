// SPDX-License-Identifier: Apache-2.0
// Response of a filter with constant gain to a slow signal: x(k) = F x(k-1) + K z(k), F = (I - K h')A.
#pragma once

#include "filters/state_models/few_states.h"

namespace ifog {

// In sample periods.
struct Settled {
  double lag = 0.0;          // group delay of r'x relative to z at zero frequency
  double correlation = 0.0;  // sum of the autocorrelation of the error r'x - rate over lags >= 0
};

// The output is r'x, the rate's part of h'x. With G(q) = r'(I - F/q)^-1 K: G(1) = r'(I-F)^-1 K, delay =
// r'(I-F)^-1 F (I-F)^-1 K / G(1). The error obeys e(k) = F e(k-1) + noise, so its autocovariance is r'F^j P r
// with the sum r'(I-F)^-1 P r.
[[nodiscard]] Settled settled(const FewStatesMatrix& transition, const FewStatesVector& h,
                              const FewStatesVector& r, const FewStatesVector& gain,
                              const FewStatesMatrix& covariance) noexcept;

}  // namespace ifog
