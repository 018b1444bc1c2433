// SPDX-License-Identifier: Apache-2.0
// Sine and cosine of our own, with only operations that IEEE 754 fixes, as log_exp.h has it: the same bits on
// every machine.
#pragma once

#include <cmath>

namespace ifog {

struct OnCircle {
  double sine = 0.0, cosine = 1.0;
};

// Sine and cosine of so many turns, by Taylor's series of an eighth of a turn at most, to 2e-9. 1e9 turns and more count
// as none.
[[nodiscard]] inline OnCircle on_circle(double turns) noexcept {
  constexpr double kPi = 0x1.921fb54442d18p+1;
  if (!(std::abs(turns) < 1e9)) return {};
  const double quarters = std::floor(4.0 * turns + 0.5);
  const double x = 2.0 * kPi * (turns - 0.25 * quarters), square = x * x;
  const double sine =
      x * (1.0 - square / 6.0 * (1.0 - square / 20.0 * (1.0 - square / 42.0 * (1.0 - square / 72.0))));
  const double cosine =
      1.0 - square / 2.0 *
                (1.0 - square / 12.0 * (1.0 - square / 30.0 * (1.0 - square / 56.0 * (1.0 - square / 90.0))));
  switch (static_cast<long long>(quarters) & 3) {
    case 0:
      return {sine, cosine};
    case 1:
      return {cosine, -sine};
    case 2:
      return {-sine, -cosine};
    default:
      return {-cosine, sine};
  }
}

}  // namespace ifog
