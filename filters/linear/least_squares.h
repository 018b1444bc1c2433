// SPDX-License-Identifier: Apache-2.0
// Least squares with possibly dependent columns.
#pragma once

#include <Eigen/Dense>

#include "filters/linear/columns.h"

namespace ifog {

// Householder QR with pivoting: of dependent columns some get no coefficient.
class LeastSquares {
 public:
  // columns: rows × p.
  explicit LeastSquares(const Eigen::MatrixXd& columns);

  [[nodiscard]] Eigen::Index rank() const;
  // The p coefficients for a measurement in the same rows.
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::VectorXd& measured) const;

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor_;
};

// Residual of the measurement after a fit of the columns.
Eigen::VectorXd left_by(const Columns& columns, const Eigen::VectorXd& measured);

// Minimum-norm solution: dependent columns share what they explain.
Eigen::VectorXd shortest_coefficients(const Eigen::MatrixXd& columns, const Eigen::VectorXd& measured);

}  // namespace ifog
