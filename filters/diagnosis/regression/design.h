// SPDX-License-Identifier: Apache-2.0
// Regression: columns, folds, and generalised least squares.
#pragma once

#include <vector>

#include "filters/diagnosis/regression/candidates.h"

namespace ifog {

// One constant per record.
Columns constants(const BlockGrid& grid);

// Columns: measurement, constants, regressors of the effects.
Columns design(const BlockData& data, const std::vector<Candidate>& effects);

// Index of an effect's column in design(). Its coefficient has index − 1, as the measurement has none.
Eigen::Index column_of(const BlockGrid& grid, std::size_t effect);

// Means of design()'s columns over the valid blocks; zero for the constants.
Eigen::RowVectorXd means_of(const BlockData& data, const std::vector<Candidate>& effects);

// Fold of each block: short contiguous pieces, alternating, so that every fold covers the whole record.
std::vector<int> folds_of(const BlockGrid& grid, int folds, std::size_t turns = 4);

// Coefficients of the columns after the first by generalised least squares, and their covariance if wanted.
Eigen::VectorXd solve(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns,
                      Eigen::MatrixXd* covariance = nullptr);

}  // namespace ifog
