// SPDX-License-Identifier: Apache-2.0
// Columns of the regression, and folds of its blocks.
#pragma once

#include <vector>

#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Effects with the noise that was fitted next to them.
struct FittedModel {
  std::vector<Candidate> effects;
  NoiseFit noise;
};

// One constant per record.
Columns constants(const BlockGrid& grid);

// Columns: measurement, constants, regressors of the effects.
Columns design(const BlockData& data, const std::vector<Candidate>& effects);

// Index of an effect's column in design(). Its coefficient has index − 1, as the measurement has none.
Eigen::Index column_of(const BlockGrid& grid, std::size_t effect);

// Means over the valid blocks: of the measurement, then of each effect for a coefficient of one.
Eigen::VectorXd means_of(const BlockData& data, const std::vector<Candidate>& effects);

}  // namespace ifog
