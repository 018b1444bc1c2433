// SPDX-License-Identifier: Apache-2.0
// Variance of a raw rate while its noise is unknown: the square of the first samples, and from the fourth sample
// on the present differences of neighbours, allowing for their small number.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>

#include "filters/estimator/estimator.h"

namespace ifog {

class FirstSamples {
 public:
  // Adds the next rate of an axis, rad/s, if valid, and returns the variance, (rad/s)^2.
  [[nodiscard]] double variance(std::size_t axis, double rate, bool valid) noexcept {
    Axis& a = axes_[axis];
    if (valid && std::isfinite(rate)) {
      // Differences, which give the variance to 6 %; a motion before them is over.
      constexpr double kMemory = 512.0;
      if (a.samples > 0.0)
        a.square += (0.5 * (rate - a.last) * (rate - a.last) - a.square) / std::min(a.samples, kMemory);
      a.samples += 1.0;
      a.last = rate;
    }
    // Rest or motion is unknown, so the square of the rate is used. One or two differences may be very small
    // by chance.
    const double own = a.last * a.last;
    if (a.samples < 2.0) return own;
    // The mean of 1 / chi-square with n d.o.f. is 1 / (n - 2); n overlapping differences have 2n/3 d.o.f.
    const double degrees = 2.0 * (a.samples - 1.0) / 3.0;
    const double found = a.square * (degrees > 3.0 ? degrees / (degrees - 2.0) : 3.0);
    return a.samples < 4.0 ? std::max(own, found) : found;
  }

 private:
  struct Axis {
    double samples = 0.0, last = 0.0, square = 0.0;
  };
  std::array<Axis, kMaxAxes> axes_{};
};

}  // namespace ifog
