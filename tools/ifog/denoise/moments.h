// SPDX-License-Identifier: Apache-2.0
// Mean and standard deviation of finite values by Welford's recurrence; NaN if there are none.
#pragma once

#include <cmath>
#include <limits>

namespace ifog::tools {

class Moments {
 public:
  void add(double value) {
    if (!std::isfinite(value)) return;
    n_ += 1.0;
    const double difference = value - mean_;
    mean_ += difference / n_;
    square_ += difference * (value - mean_);
  }
  [[nodiscard]] double count() const { return n_; }
  [[nodiscard]] double mean() const { return n_ > 0.0 ? mean_ : std::numeric_limits<double>::quiet_NaN(); }
  // 0 for a single value.
  [[nodiscard]] double deviation() const {
    return n_ > 0.0 ? std::sqrt(square_ / std::fmax(1.0, n_ - 1.0)) : mean();
  }

 private:
  double n_ = 0.0, mean_ = 0.0, square_ = 0.0;
};

}  // namespace ifog::tools
