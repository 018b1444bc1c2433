// SPDX-License-Identifier: Apache-2.0
#include "filters/diagnosis/regression/design.h"

#include <algorithm>

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

Eigen::VectorXd means_of(const BlockData& data, const std::vector<Candidate>& effects) {
  const auto mean = [&](const Eigen::VectorXd& column) {
    double sum = 0.0;
    for (std::size_t b = 0; b < data.grid.size(); ++b)
      if (data.grid.valid[b]) sum += column[static_cast<Eigen::Index>(b)];
    return sum / std::max(1.0, static_cast<double>(data.grid.used()));
  };
  Eigen::VectorXd means(static_cast<Eigen::Index>(effects.size()) + 1);
  means[0] = mean(data.grid.error);
  for (std::size_t i = 0; i < effects.size(); ++i)
    means[static_cast<Eigen::Index>(i) + 1] = mean(regressor(data, effects[i]));
  return means;
}

}  // namespace ifog
