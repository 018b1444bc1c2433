// SPDX-License-Identifier: Apache-2.0
// Autoregressive noise model for whitening a series.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <vector>

namespace ifog {

// Prediction of a series from its last values; the prediction errors are white.
class Autoregression {
 public:
  static constexpr std::size_t kOrder = 16;

  Autoregression() = default;  // white noise
  explicit Autoregression(const std::vector<double>& series) {
    double mean = 0.0, count = 0.0;
    for (const double value : series)
      if (std::isfinite(value)) mean += value, count += 1.0;
    mean /= std::max(count, 1.0);
    std::array<double, kOrder + 1> covariance{};
    for (std::size_t lag = 0; lag <= kOrder; ++lag)
      for (std::size_t i = lag; i < series.size(); ++i) {
        const double product = (series[i] - mean) * (series[i - lag] - mean);
        if (std::isfinite(product)) covariance[lag] += product;
      }
    covariance[0] *= 1.0 + 1e-9;
    if (!(covariance[0] > 0.0)) return;
    Eigen::Matrix<double, kOrder, kOrder> equations;  // Yule-Walker equations
    Eigen::Matrix<double, kOrder, 1> right;
    for (std::size_t i = 0; i < kOrder; ++i) {
      const auto row = static_cast<Eigen::Index>(i);
      right[row] = covariance[i + 1];
      for (std::size_t j = 0; j < kOrder; ++j)
        equations(row, static_cast<Eigen::Index>(j)) = covariance[i > j ? i - j : j - i];
    }
    const Eigen::Matrix<double, kOrder, 1> weight = equations.ldlt().solve(right);
    std::copy(weight.begin(), weight.end(), weight_.begin());
  }

  // NaN if one of the values before is missing.
  [[nodiscard]] std::vector<double> whitened(const std::vector<double>& series) const {
    std::vector<double> out(series.size(), std::nan(""));
    for (std::size_t i = kOrder; i < series.size(); ++i) {
      out[i] = series[i];
      for (std::size_t k = 0; k < kOrder; ++k) out[i] -= weight_[k] * series[i - 1 - k];
    }
    return out;
  }

 private:
  std::array<double, kOrder> weight_{};
};

}  // namespace ifog
