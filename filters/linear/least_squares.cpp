// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/least_squares.h"

namespace ifog {

LeastSquares::LeastSquares(const Eigen::MatrixXd& columns) : factor_(columns) {}

Eigen::Index LeastSquares::rank() const { return factor_.rank(); }

Eigen::VectorXd LeastSquares::coefficients(const Eigen::VectorXd& measured) const {
  return factor_.solve(measured);
}

Eigen::VectorXd left_by(const Columns& columns, const Eigen::VectorXd& measured) {
  return measured - columns * LeastSquares(columns).coefficients(measured);
}

Eigen::VectorXd shortest_coefficients(const Eigen::MatrixXd& columns, const Eigen::VectorXd& measured) {
  return Eigen::CompleteOrthogonalDecomposition<Eigen::MatrixXd>(columns).solve(measured);
}

}  // namespace ifog
