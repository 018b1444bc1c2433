// SPDX-License-Identifier: Apache-2.0
#pragma once

#include <Eigen/Dense>
#include <algorithm>
#include <cmath>
#include <cstddef>
#include <cstdint>
#include <vector>

#include "filters/linear/normal_equations.h"

namespace ifog {

struct SeriesFit {
  Eigen::VectorXd coefficients;
  double square = 0.0;  // of the residual
  double last_variance = 0.0;
  std::size_t rows = 0;
};

// Least squares of the first column on the others, over the given rows.
inline SeriesFit least_squares(const std::vector<std::vector<double>>& columns,
                               const std::vector<std::uint8_t>& rows) {
  const auto width = static_cast<Eigen::Index>(columns.size());
  Eigen::MatrixXd gram = Eigen::MatrixXd::Zero(width, width);
  Eigen::VectorXd row(width);
  SeriesFit fit;
  for (std::size_t i = 0; i < rows.size(); ++i) {
    if (!rows[i]) continue;
    for (Eigen::Index c = 0; c < width; ++c) row[c] = columns[static_cast<std::size_t>(c)][i];
    gram.selfadjointView<Eigen::Lower>().rankUpdate(row);
    ++fit.rows;
  }
  gram.triangularView<Eigen::StrictlyUpper>() = gram.transpose();
  const Eigen::Index p = width - 1;
  const NormalEquations equations = NormalEquations::of_measured_first(gram);
  fit.coefficients = equations.coefficients();
  fit.square = std::max(gram(0, 0) - equations.explained(), 1e-12 * gram(0, 0));
  const double freedom = std::max(1.0, static_cast<double>(fit.rows) - static_cast<double>(p));
  fit.last_variance = fit.square / freedom * equations.inverse()(p - 1, p - 1);
  return fit;
}

inline std::vector<std::uint8_t> complete_rows(const std::vector<std::vector<double>>& columns) {
  std::vector<std::uint8_t> rows(columns.front().size(), 1);
  for (const std::vector<double>& column : columns)
    for (std::size_t i = 0; i < rows.size(); ++i)
      if (!std::isfinite(column[i])) rows[i] = 0;
  return rows;
}

}  // namespace ifog
