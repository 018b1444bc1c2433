// SPDX-License-Identifier: Apache-2.0
// Fit of a candidate to the spectrum: Whittle's likelihood (Arkiv för Matematik 2, 1953), in which the
// squares of the cosine transform are independent. It costs thousands of bins instead of hundreds of
// thousands of filter steps, so many starts are possible.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "filters/tune/candidate.h"
#include "filters/tune/spectrum.h"

namespace ifog {

struct WhittleOptimum {
  std::vector<double> theta;
  double cost = 0.0;  // −ln L except for a constant
};

// Local optima, best first; no two within 0.1 of log-likelihood. Of `draws` random starts the best third is
// optimised.
[[nodiscard]] std::vector<WhittleOptimum> whittle_optima(const ModelCandidate& candidate,
                                                         const RecordSpectrum& spectrum, std::size_t draws);

// Fisher information of theta, the inverse of its expected covariance; rows of undetermined parameters are
// zero.
[[nodiscard]] Eigen::MatrixXd whittle_information(const ModelCandidate& candidate,
                                                  const RecordSpectrum& spectrum,
                                                  const std::vector<double>& theta);

}  // namespace ifog
