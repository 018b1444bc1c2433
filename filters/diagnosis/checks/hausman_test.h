// SPDX-License-Identifier: Apache-2.0
// Whether an effect is the same for what is quick and for what is slow. Innovations weigh quick changes;
// where the noise is not what the model takes it for, a coefficient fitted to them can be far too large for
// the slow part of the error, and the correction would make it larger.
#pragma once

#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

// Difference between the coefficient of the last column by plain least squares, which slow parts dominate,
// and by the fit in innovations, in standard deviations of that difference under the noise model (the
// specification test of Hausman 1978). columns: measurement, constants (`nuisances` of them), regressors.
// coefficients and covariance: those of solve(), of all columns but the first.
double disagreement(const BlockGrid& grid, const NoiseFit& noise, const Columns& columns,
                    Eigen::Index nuisances, const Eigen::VectorXd& coefficients,
                    const Eigen::MatrixXd& covariance);

}  // namespace ifog
