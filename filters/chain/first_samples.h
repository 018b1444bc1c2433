// SPDX-License-Identifier: Apache-2.0
// Variance of a raw rate while nothing is known of its noise yet: of the first samples all that they say,
// from the fourth on what neighbours differ by, with what so few differences leave open.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "filters/estimator/estimator.h"

namespace ifog {

class FirstSamples {
 public:
  // rate: the next one of an axis, rad/s; valid: it is one. (rad/s)^2.
  [[nodiscard]] double variance(std::size_t axis, double rate, bool valid) noexcept {
    Axis& a = axes_[axis];
    if (valid && std::isfinite(rate)) {
      if (a.samples > 0.0) a.squares += 0.5 * (rate - a.last) * (rate - a.last);
      a.samples += 1.0;
      a.last = rate;
    }
    // Rest or motion, nobody knows: the rate's own square is the least assumption. One or two differences may
    // be next to nothing by chance, and 1 / chi-square has no mean then.
    const double own = a.last * a.last;
    if (a.samples < 2.0) return own;
    // Mean of 1 / chi-square with n degrees of freedom is 1 / (n - 2); neighbouring differences share a
    // sample, so that n of them are 2n/3 degrees.
    const double degrees = 2.0 * (a.samples - 1.0) / 3.0;
    const double found = a.squares / (a.samples - 1.0) * (degrees > 3.0 ? degrees / (degrees - 2.0) : 3.0);
    return a.samples < 4.0 ? std::max(own, found) : found;
  }

 private:
  struct Axis {
    double samples = 0.0, last = 0.0, squares = 0.0;
  };
  std::array<Axis, kMaxAxes> axes_{};
};

}  // namespace ifog
