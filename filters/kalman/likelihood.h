// Exact Gaussian likelihood of a record under a state model and white measurement noise, by the prediction
// error decomposition: Harvey, "Forecasting, Structural Time Series Models and the Kalman Filter",
// section 3.4.
#pragma once

#include <span>
#include <vector>

#include "filters/state_models/state_model.h"

namespace ifog {

// Sums over the measurements that count: missing ones (NaN) do not, nor the first d of them for d states that
// wander without bound, which only fix where the process starts (diffuse likelihood).
struct LikelihoodTerms {
  long count = 0;
  double sum_log_variance = 0.0;  // of ln S, S the innovation variance
  double sum_normalised = 0.0;    // of nu^2 / S

  [[nodiscard]] double log_likelihood() const;
  // The likelihood's maximum over a common factor of Q and R, which is sum_normalised / count.
  [[nodiscard]] double concentrated_log_likelihood() const;
};

// rate in rad/s at a constant dt_s, NaN where missing; process_noise and measurement_noise as in
// FilterSettings. Stationary states start from their stationary law, the others from the first measurement
// with a variance of 1e9 times the noise: the likelihood then differs from the diffuse limit by some 1e-9 of
// itself. innovations, when given, receives nu / sqrt(S) per sample, NaN where missing or not counted.
LikelihoodTerms likelihood(const StateModel& model, double process_noise, double measurement_noise,
                           std::span<const double> rate, double dt_s,
                           std::vector<double>* innovations = nullptr);

// likelihood().log_likelihood(), for an optimiser.
double log_likelihood(const StateModel& model, double process_noise, double measurement_noise,
                      std::span<const double> rate, double dt_s);

}  // namespace ifog
