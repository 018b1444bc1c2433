// SPDX-License-Identifier: Apache-2.0
// Normal equations X'X c = X'y of a least-squares fit, solved with columns scaled to unit length, as
// regressors differ by many powers of ten.
#pragma once

#include <Eigen/Dense>

#include "filters/linear/symmetric.h"

namespace ifog {

class NormalEquations {
 public:
  // gram: X'X (p × p), with priors of coefficients on its diagonal. right: X'y (p).
  NormalEquations(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right);
  // gram: of [y X], (1+p) × (1+p).
  static NormalEquations of_measured_first(const Eigen::MatrixXd& gram);

  // c (p).
  [[nodiscard]] Eigen::VectorXd coefficients() const;
  // Reduction of y'y by the fit; the residual's square is y'y minus this.
  [[nodiscard]] double explained() const;
  // (X'X)⁻¹: the coefficients' covariance at a variance of 1 in each row.
  [[nodiscard]] Eigen::MatrixXd inverse() const;
  // log det X'X, with pivots limited to 1e-15 of their column.
  [[nodiscard]] double log_determinant() const;

 private:
  Eigen::VectorXd scale_, right_;
  SymmetricSolver solver_;
  Eigen::VectorXd solution_;  // scaled
};

}  // namespace ifog
