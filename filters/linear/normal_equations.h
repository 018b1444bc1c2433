// SPDX-License-Identifier: Apache-2.0
// The normal equations X'X c = X'y of a least-squares fit, solved in units in which each column has the
// length 1: regressors differ by many powers of ten.
#pragma once

#include <Eigen/Dense>

#include "filters/linear/symmetric.h"

namespace ifog {

class NormalEquations {
 public:
  // gram: X'X (p × p; what is known of coefficients beforehand is on its diagonal). right: X'y (p).
  NormalEquations(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right);
  // gram: of y and X side by side, (1+p) × (1+p).
  static NormalEquations of_measured_first(const Eigen::MatrixXd& gram);

  // c (p).
  [[nodiscard]] Eigen::VectorXd coefficients() const;
  // What they take off y'y: the square that is left is y'y less this.
  [[nodiscard]] double explained() const;
  // (X'X)⁻¹: the coefficients' covariance at a variance of 1 in each row.
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  // log det X'X, a pivot of 1e-15 of its column standing for any below.
  [[nodiscard]] double log_determinant() const;

 private:
  Eigen::VectorXd scale_, right_;
  SymmetricSolver solver_;
  Eigen::VectorXd solution_;  // scaled
};

}  // namespace ifog
