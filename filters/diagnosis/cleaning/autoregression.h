// SPDX-License-Identifier: Apache-2.0
// Autoregressive noise model for whitening series.
#pragma once

#include <Eigen/Dense>
#include <cmath>
#include <limits>

#include "filters/linear/columns.h"
#include "filters/series/finite_sum.h"

namespace ifog {

// Prediction of a series from its last values; the prediction errors are white.
class Autoregression {
 public:
  // series: NaN where missing.
  explicit Autoregression(const Eigen::VectorXd& series) {
    const auto [sum, count] = finite_sum({series.data(), static_cast<std::size_t>(series.size())});
    const Eigen::ArrayXd about_mean = series.array() - sum / std::max(count, 1.0);
    Eigen::VectorXd covariance(kOrder + 1);
    for (Eigen::Index lag = 0; lag <= kOrder; ++lag) {
      const Eigen::Index n = std::max<Eigen::Index>(0, series.size() - lag);
      const Eigen::ArrayXd products = about_mean.tail(n) * about_mean.head(n);
      covariance[lag] = products.isFinite().select(products, 0.0).sum();
    }
    covariance[0] *= 1.0 + 1e-9;
    if (!(covariance[0] > 0.0)) return;
    Eigen::Matrix<double, kOrder, kOrder> equations;  // of Yule and Walker
    for (Eigen::Index i = 0; i < kOrder; ++i)
      for (Eigen::Index j = 0; j < kOrder; ++j) equations(i, j) = covariance[std::abs(i - j)];
    weight_ = equations.ldlt().solve(covariance.tail(kOrder));
  }

  // Each column; NaN if one of the values before is missing.
  [[nodiscard]] Columns whitened(const Columns& columns) const {
    const Eigen::Index n = std::max<Eigen::Index>(0, columns.rows() - kOrder);
    Columns white =
        Columns::Constant(columns.rows(), columns.cols(), std::numeric_limits<double>::quiet_NaN());
    white.bottomRows(n) = columns.bottomRows(n);
    for (Eigen::Index k = 0; k < kOrder; ++k)
      white.bottomRows(n) -= weight_[k] * columns.middleRows(kOrder - 1 - k, n);
    return white;
  }

 private:
  static constexpr Eigen::Index kOrder = 16;
  Eigen::Matrix<double, kOrder, 1> weight_ = Eigen::Matrix<double, kOrder, 1>::Zero();
};

}  // namespace ifog
