// SPDX-License-Identifier: Apache-2.0
// Maximum of the record's likelihood, from a start given by the spectrum; and the curvature there.
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
  // −ln L of the scaled data; very large if the filter is invalid.
  [[nodiscard]] double operator()(std::span<const double> theta) const;
  [[nodiscard]] const ModelCandidate& candidate() const { return candidate_; }

 private:
  const ModelCandidate& candidate_;
  const LikelihoodRecord& record_;
  double period_s_;
};

// Moves theta to the local optimum and returns −ln L there. information: expected at theta, for size and
// direction of the first steps; a zero row means a step of one.
double find_maximum(const RecordObjective& objective, const Eigen::MatrixXd& information,
                    std::vector<double>& theta);

// Inverse of the curvature of −ln L. known: false for parameters at a bound or undetermined by the data;
// their rows are zero.
Eigen::MatrixXd covariance_at(const RecordObjective& objective, const Eigen::MatrixXd& information,
                              const std::vector<double>& theta, std::vector<bool>& known);

// Returns true if the record does not distinguish the level's walk from none within 0.5 of -ln L. Then theta
// is the fastest walk within 0.5 of the best (one standard deviation). A filter without a walk would not
// follow a moving level, while a walk that is too fast costs little.
[[nodiscard]] bool bound_hidden_walk(const RecordObjective& objective, std::vector<double>& theta);

}  // namespace ifog
