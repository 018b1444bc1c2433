// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/design.h"

#include <algorithm>

#include "filters/linear/normal_equations.h"

namespace ifog {

Columns constants(const BlockGrid& grid) {
  Columns columns = Columns::Zero(static_cast<Eigen::Index>(grid.size()), grid.constants());
  Eigen::Index column = 0;
  for (const BlockRange& record : grid.records)
    columns.col(column++).segment(record.row(), record.rows()).setOnes();
  return columns;
}

Columns design(const BlockData& data, const std::vector<Candidate>& effects) {
  const Columns constant = constants(data.grid);
  Columns columns(constant.rows(), 1 + constant.cols() + static_cast<Eigen::Index>(effects.size()));
  columns.col(0) = data.grid.error;
  columns.middleCols(1, constant.cols()) = constant;
  Eigen::Index at = 1 + constant.cols();
  for (const Candidate& effect : effects) columns.col(at++) = regressor(data, effect);
  return columns;
}

Eigen::Index column_of(const BlockGrid& grid, std::size_t effect) {
  return 1 + grid.constants() + static_cast<Eigen::Index>(effect);
}

Eigen::RowVectorXd means_of(const BlockData& data, const std::vector<Candidate>& effects) {
  const BlockGrid& grid = data.grid;
  const Columns columns = design(data, effects);
  Eigen::RowVectorXd sum = Eigen::RowVectorXd::Zero(columns.cols());
  for (std::size_t b = 0; b < grid.size(); ++b)
    if (grid.valid[b]) sum += columns.row(static_cast<Eigen::Index>(b));
  sum.segment(1, grid.constants()).setZero();
  return sum / std::max(1.0, static_cast<double>(grid.used()));
}

std::vector<int> folds_of(const BlockGrid& grid, int folds, std::size_t turns) {
  std::vector<int> fold(grid.size());
  for (const BlockRange& record : grid.records) {
    const std::size_t n = record.size();
    for (std::size_t b = 0; b < n; ++b) {
      const std::size_t piece = b * turns * static_cast<std::size_t>(folds) / n;
      fold[record.first + b] = static_cast<int>(piece) % folds;
    }
  }
  return fold;
}

Eigen::VectorXd solve(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns,
                      Eigen::MatrixXd* covariance) {
  Columns white = columns;
  const Whitening filter(grid, shape);
  filter.apply(white);
  const Eigen::Index p = columns.cols() - 1;
  const Eigen::MatrixXd gram = white.transpose() * white;
  const NormalEquations fit = NormalEquations::of_measured_first(gram);
  if (covariance) {
    const double left = std::max(gram(0, 0) - fit.explained(), 0.0);
    const double variance = left / std::max(1.0, static_cast<double>(grid.used()) - static_cast<double>(p));
    *covariance = variance * fit.inverse();
  }
  return fit.coefficients();
}

}  // namespace ifog
