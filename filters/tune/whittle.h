// SPDX-License-Identifier: Apache-2.0
// A candidate fitted to the record's spectrum alone: Whittle's likelihood (Arkiv för Matematik 2, 1953), each
// square of the cosine transform an independent one of its expected density. It costs thousands of bins where
// the likelihood of the record costs hundreds of thousands of filter steps, so it can be asked from many
// starts.
#pragma once

#include <Eigen/Dense>
#include <vector>

#include "filters/tune/candidate.h"
#include "filters/tune/spectrum.h"

namespace ifog {

struct WhittleOptimum {
  std::vector<double> theta;
  double cost = 0.0;  // −ln L but for a constant
};

// Local optima, the best first, no two within a tenth of a log-likelihood unit of each other. `draws` starts
// are drawn, the most promising third of them followed.
[[nodiscard]] std::vector<WhittleOptimum> whittle_optima(const ModelCandidate& candidate,
                                                         const RecordSpectrum& spectrum, std::size_t draws);

// Fisher's information of theta, what the inverse of its covariance will be; rows of what the spectrum does
// not tell are zero.
[[nodiscard]] Eigen::MatrixXd whittle_information(const ModelCandidate& candidate,
                                                  const RecordSpectrum& spectrum,
                                                  const std::vector<double>& theta);

}  // namespace ifog
