// SPDX-License-Identifier: Apache-2.0
// Least squares on columns that may depend on each other.
#pragma once

#include <Eigen/Dense>

#include "filters/linear/columns.h"

namespace ifog {

// By Householder QR with pivoting: of dependent columns some get no coefficient.
class LeastSquares {
 public:
  // columns: rows × p.
  explicit LeastSquares(const Eigen::MatrixXd& columns);

  [[nodiscard]] Eigen::Index rank() const;
  // The p coefficients for what was measured in the same rows.
  [[nodiscard]] Eigen::VectorXd coefficients(const Eigen::VectorXd& measured) const;

 private:
  Eigen::ColPivHouseholderQR<Eigen::MatrixXd> factor_;
};

// What a fit of the columns leaves of the measured.
Eigen::VectorXd left_by(const Columns& columns, const Eigen::VectorXd& measured);

// The shortest of all coefficients that fit equally well: dependent columns share what they explain.
Eigen::VectorXd shortest_coefficients(const Eigen::MatrixXd& columns, const Eigen::VectorXd& measured);

}  // namespace ifog
