// SPDX-License-Identifier: Apache-2.0
// The maximum of the likelihood of the whole record, from where the spectrum says it should be; and the
// curvature there.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "filters/kalman/likelihood.h"
#include "filters/tune/candidate.h"

namespace ifog {

class RecordObjective {
 public:
  RecordObjective(const ModelCandidate& candidate, const LikelihoodRecord& record, double period_s)
      : candidate_(candidate), record_(record), period_s_(period_s) {}
  // −ln L of the scaled data; a very large number where the filter has none.
  [[nodiscard]] double operator()(std::span<const double> theta) const;
  [[nodiscard]] const ModelCandidate& candidate() const { return candidate_; }

 private:
  const ModelCandidate& candidate_;
  const LikelihoodRecord& record_;
  double period_s_;
};

// Moves theta to the optimum nearby and returns −ln L there. information: expected, at theta, for the size
// and the direction of the first steps; with a zero row a step is one.
double find_maximum(const RecordObjective& objective, const Eigen::MatrixXd& information,
                    std::vector<double>& theta);

// Inverse of the curvature of −ln L. known: false for parameters at a bound or along which the data do not
// tell, whose rows are zero.
Eigen::MatrixXd covariance_at(const RecordObjective& objective, const Eigen::MatrixXd& information,
                              const std::vector<double>& theta, std::vector<bool>& known);

}  // namespace ifog
