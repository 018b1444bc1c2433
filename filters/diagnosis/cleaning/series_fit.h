// SPDX-License-Identifier: Apache-2.0
// Least squares of series with missing values.
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <vector>

#include "filters/linear/columns.h"
#include "filters/linear/normal_equations.h"

namespace ifog {

struct SeriesFit {
  Eigen::VectorXd coefficients;
  double square = 0.0;  // of the residual
};

// Rows without a missing value.
inline std::vector<Eigen::Index> complete_rows(const Columns& columns) {
  std::vector<Eigen::Index> rows;
  for (Eigen::Index i = 0; i < columns.rows(); ++i)
    if (columns.row(i).allFinite()) rows.push_back(i);
  return rows;
}

// Least squares of the first column on the others, over the given rows.
inline SeriesFit least_squares(const Columns& columns, const std::vector<Eigen::Index>& rows) {
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(columns.cols(), columns.cols());
  for (const Eigen::Index i : rows)
    gram.selfadjointView<Eigen::Lower>().rankUpdate(columns.row(i).transpose());
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  const NormalEquations equations = NormalEquations::of_measured_first(gram);
  SeriesFit fit;
  fit.coefficients = equations.coefficients();
  fit.square = std::max(gram(0, 0) - equations.explained(), 1e-12 * gram(0, 0));
  return fit;
}

}  // namespace ifog
