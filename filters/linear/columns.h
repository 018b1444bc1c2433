// SPDX-License-Identifier: Apache-2.0
// Regressors as columns; rows are blocks or samples.
#pragma once

#include <Eigen/Dense>

namespace ifog {

using Columns =
    Eigen::Matrix<double, Eigen::Dynamic, Eigen::Dynamic, Eigen::RowMajor>;  // row by row in memory

}  // namespace ifog
