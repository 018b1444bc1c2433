// SPDX-License-Identifier: Apache-2.0
// Sum of many terms whose error is one rounding.
#pragma once

namespace ifog {

// Carries the rounding error of each addition along (Knuth, TAOCP vol. 2, 4.2.2 theorem B). A plain sum of
// 4·10⁸ increments of an angle may lose 1e-9 rad.
class ExactSum {
 public:
  void add(double term) noexcept {
    const double sum = sum_ + term, added = sum - sum_;
    lost_ += (sum_ - (sum - added)) + (term - added);
    sum_ = sum;
  }
  [[nodiscard]] double value() const noexcept { return sum_ + lost_; }

 private:
  double sum_ = 0.0, lost_ = 0.0;
};

}  // namespace ifog
