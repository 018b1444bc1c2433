// SPDX-License-Identifier: Apache-2.0
// What the fit does not know. A coefficient's error depends on the slow noise, which the record itself has to
// tell, and of which it holds few independent pieces: taking the likeliest noise for the true one makes
// intervals too narrow, the more so where the likeliest walk is zero. So the coefficients are averaged over
// the noise parameters the record allows, each weighted by its restricted likelihood, and their spread
// counts. Time constants that were searched are free along with the coefficients (Gauss-Newton).
#pragma once

#include <vector>

#include "filters/diagnosis/diagnosis.h"
#include "filters/diagnosis/regression/candidates.h"
#include "filters/diagnosis/regression/noise_fit.h"

namespace ifog {

struct JointFit {
  NoisePosterior noise;
  // Nuisances (one constant a record), the coefficient of each effect, then one entry for each searched
  // parameter, in their order: the logarithm of a time constant, or of a half width and the middle in half widths.
  Eigen::VectorXd values;
  Eigen::MatrixXd covariance;
  // Covariance of the coefficients with the searched parameters known. It decides whether there is an effect: where
  // there is none, no time constant changes anything.
  Eigen::MatrixXd of_coefficients;
  std::vector<std::size_t> searched;  // effect of each of those last entries
};

// Effects as the search left them, `coefficients` theirs, `best` the likeliest noise.
JointFit joint_fit(const BlockData& data, const std::vector<Candidate>& effects,
                   const Eigen::VectorXd& coefficients, const NoiseFit& best);

// The same at the time constants that the effects have.
JointFit joint_fit_at(const BlockData& data, const std::vector<Candidate>& effects, const NoiseFit& best);

// Derivatives of the sum of the effects with respect to what was searched, one column each.
Columns searched_columns(const BlockData& data, const std::vector<Candidate>& effects,
                         const Eigen::VectorXd& coefficients, Eigen::Index nuisances,
                         std::vector<std::size_t>* of = nullptr);

}  // namespace ifog
