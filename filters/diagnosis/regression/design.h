// SPDX-License-Identifier: Apache-2.0
// The regression itself: which columns there are, which blocks stand together, and generalised least squares.
#pragma once

#include <vector>

#include "filters/diagnosis/regression/candidates.h"

namespace ifog {

// One constant a record.
Columns constants(const BlockGrid& grid);

// Measurement, constants, and the regressors of the effects.
Columns design(const BlockData& data, const std::vector<Candidate>& effects);

// Where among them the column of effect `effect` is; its coefficient is one before, as the measurement has none.
Eigen::Index column_of(const BlockGrid& grid, std::size_t effect);

// Mean over the valid blocks of the measurement less what the effects make of it. columns: of design();
// coefficients: of the columns after the measurement, of which the constants stay in the mean.
double mean_left(const BlockGrid& grid, const Columns& columns, const Eigen::VectorXd& coefficients);

// Which of `folds` each block belongs to: short contiguous pieces in turn, so that every fold sees the whole
// record.
std::vector<int> folds_of(const BlockGrid& grid, int folds, std::size_t turns = 4);

// Coefficients of the columns after the first by generalised least squares; their covariance too, when asked
// for.
Eigen::VectorXd solve(const BlockGrid& grid, const NoiseShape& shape, const Columns& columns,
                      Eigen::MatrixXd* covariance = nullptr);

}  // namespace ifog
