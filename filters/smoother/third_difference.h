// SPDX-License-Identifier: Apache-2.0
// The square of the difference that a parabola does not show, of four measurements of an axis in a row,
// whatever samples are missing between them: a divided difference, scaled so that of white noise R it is R.
#pragma once

#include <algorithm>
#include <array>
#include <cstddef>

namespace ifog {

// rates: oldest first; steps: samples from each but the first to the one before it, whole numbers >= 1.
[[nodiscard]] inline double third_difference_square(const std::array<double, 4>& rates,
                                                    const std::array<double, 3>& steps) noexcept {
  if (steps[0] == steps[1] && steps[1] == steps[2]) {
    const double third = rates[3] - 3.0 * rates[2] + 3.0 * rates[1] - rates[0];
    return third * third / 20.0;
  }
  std::array<double, 4> at{};
  for (std::size_t i = 0; i < 3; ++i) at[i + 1] = at[i] + steps[i];
  double sum = 0.0, squares = 0.0;
  for (std::size_t i = 0; i < 4; ++i) {
    double apart = 1.0;
    for (std::size_t j = 0; j < 4; ++j)
      if (j != i) apart *= at[i] - at[j];
    sum += rates[i] / apart;
    squares += 1.0 / (apart * apart);
  }
  return sum * sum / squares;
}

// Which differences are asked: those over as few samples as any lately, for a motion shows in one by the
// sixth power of that.
class ShortestSpan {
 public:
  // The span of the next difference, samples: whether to ask it.
  bool take(double span) noexcept {
    if (++count_ > kTurn) {
      before_ = now_;
      now_ = span;
      count_ = 1;
    }
    now_ = std::min(now_, span);
    return span <= std::min(now_, before_);
  }

 private:
  static constexpr int kTurn = 32;
  static constexpr double kNone = 1e300;
  double now_ = kNone, before_ = kNone;
  int count_ = 0;
};

}  // namespace ifog
