// SPDX-License-Identifier: Apache-2.0
#include "filters/linear/normal_equations.h"

#include <algorithm>
#include <cmath>

namespace ifog {

NormalEquations::NormalEquations(const Eigen::MatrixXd& gram, const Eigen::VectorXd& right)
    : scale_(gram.diagonal().cwiseMax(1e-300).cwiseSqrt().cwiseInverse()),
      right_(scale_.asDiagonal() * right),
      solver_(scale_.asDiagonal() * gram * scale_.asDiagonal()),
      solution_(solver_.solve(right_)) {}

NormalEquations NormalEquations::of_measured_first(const Eigen::MatrixXd& gram) {
  const Eigen::Index p = gram.cols() - 1;
  return {gram.bottomRightCorner(p, p), gram.col(0).tail(p)};
}

Eigen::VectorXd NormalEquations::coefficients() const { return scale_.asDiagonal() * solution_; }

double NormalEquations::explained() const { return right_.dot(solution_); }

Eigen::MatrixXd NormalEquations::inverse() const {
  return scale_.asDiagonal() * solver_.inverse() * scale_.asDiagonal();
}

double NormalEquations::log_determinant() const {
  double sum = -2.0 * scale_.array().log().sum();
  for (const double pivot : solver_.pivots()) sum += std::log(std::max(pivot, 1e-15));
  return sum;
}

}  // namespace ifog
