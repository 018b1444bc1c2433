// SPDX-License-Identifier: Apache-2.0
// Gaussian likelihood of a record under a state model and white measurement noise, by the prediction error
// decomposition: Harvey, "Forecasting, Structural Time Series Models and the Kalman Filter", section 3.4.
//
// Exact where the gain changes from sample to sample. It does not for long: k samples after the start it
// changes by a share of 1/k a sample at most, so it is then held over k/256 samples and less, at its value in
// the middle of them, while the covariance is carried over them exactly (by doubling). What that does to the
// likelihood is of second order in the change, and a smooth function of the parameters: below 0.01 in records
// of 200 000 samples, where half a unit is what a parameter is worth.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/state_models/state_model.h"

namespace ifog {

// Axes with the same samples missing, laid out for a filter that takes them side by side.
class LikelihoodRecord {
 public:
  // rad/s, evenly spaced, NaN where missing.
  explicit LikelihoodRecord(std::span<const std::span<const double>> axes);

  struct Run {
    std::size_t length = 0;
    bool missing = false;
  };
  // `lanes` values a sample, the axes first and zeros after them.
  struct Group {
    std::size_t axes = 0, lanes = 0;
    std::vector<Run> runs;
    std::vector<double> rows;
  };
  [[nodiscard]] const std::vector<Group>& groups() const { return groups_; }

 private:
  std::vector<Group> groups_;
};

// Sums over the measurements that count: missing ones (NaN) do not, nor the first d of them for d states that
// wander without bound, which only fix where the process starts (diffuse likelihood).
struct LikelihoodTerms {
  long count = 0;
  double sum_log_variance = 0.0;  // of ln S, S the innovation variance
  double sum_normalised = 0.0;    // of nu^2 / S

  [[nodiscard]] double log_likelihood() const;
};

// process_noise and measurement_noise (> 0) as in FilterSettings, one measurement every dt_s. Stationary
// states start from their stationary law, the others from the first measurement with a variance of 1e9 times
// the noise: the likelihood then differs from the diffuse limit by some 1e-9 of itself.
[[nodiscard]] LikelihoodTerms likelihood(const StateModel& model, double process_noise,
                                         double measurement_noise, const LikelihoodRecord& record,
                                         double dt_s);

// Likelihood terms of one axis.
[[nodiscard]] LikelihoodTerms likelihood(const StateModel& model, double process_noise,
                                         double measurement_noise, std::span<const double> rate, double dt_s);

}  // namespace ifog
