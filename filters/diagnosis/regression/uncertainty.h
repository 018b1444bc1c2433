// SPDX-License-Identifier: Apache-2.0
// Uncertainty of the fit. A coefficient's error depends on the slow noise, of which a record has few
// independent pieces. With the most likely noise alone the intervals would be too narrow, especially if the
// most likely walk is zero. So coefficients are averaged over the possible noise parameters, weighted by
// restricted likelihood. Searched time constants are free parameters (Gauss-Newton).
#pragma once

#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

struct JointFit {
  NoisePosterior noise;
  // Nuisances (one constant per record), one coefficient per effect, then the searched parameters in order:
  // logarithm of a time constant, or logarithm of a half width and centre in half widths.
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
  // Covariance of the coefficients with the searched parameters fixed. It decides on significance, since
  // without an effect time constants have no influence.
  Eigen::MatrixXd of_coefficients;
  std::vector<std::size_t> searched;  // effects of the searched parameters
};

// effects: as the search left them; best: most likely noise; coefficients: of the effects, without which their time
// constants are fixed.
JointFit joint_fit(const BlockData& data, const std::vector<Candidate>& effects, const NoiseFit& best,
                   const Eigen::VectorXd* coefficients = nullptr);

// Derivatives of the sum of the effects by the searched parameters, one column each.
Columns searched_columns(const BlockData& data, const std::vector<Candidate>& effects,
                         const Eigen::VectorXd& coefficients, Eigen::Index nuisances,
                         std::vector<std::size_t>* of = nullptr);

}  // namespace ifog
