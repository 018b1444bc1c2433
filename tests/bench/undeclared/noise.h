// SPDX-License-Identifier: Apache-2.0
// The sensor's noise with its exact state space. An oracle that knows the truth and shares no code with the
// diagnosis computes an effect's visibility from it.
#pragma once

#include <cstddef>
#include <memory>
#include <vector>

#include "tests/bench/undeclared/draw.h"

namespace ifog::undeclared {

// IEEE Std 952 terms, SI. White noise N rad/s/sqrt(Hz), bias instability B rad/s, rate random walk K
// rad/s^2/sqrt(Hz).
struct NoiseTruth {
  double N = 0.0, B = 0.0, K = 0.0;
};

// White noise, random walk and 1/f noise. The latter is a sum of Gauss-Markov processes with time constants
// from one sample to ten records at a ratio of 2.5: one-sided density B^2 / (2 pi f) within 5 % up to a
// sixtieth of the sample rate. Above, white noise dominates.
class NoiseModel {
 public:
  NoiseModel(const NoiseTruth& truth, std::size_t samples, double dt_s);

  // n samples; the random walk begins at zero, because the switch-on bias is added elsewhere.
  [[nodiscard]] std::vector<double> draw(Draw& draw) const;

  // Innovations of a column divided by their standard deviations: unit white noise if the column is this
  // noise.
  [[nodiscard]] std::vector<double> whiten(const std::vector<double>& column) const;
  [[nodiscard]] double log_determinant() const;  // of the covariance of all samples

 private:
  std::size_t samples_;
  double white_sigma_, walk_sigma_;
  std::vector<double> decay_, drive_sigma_, start_variance_;  // of the Gauss-Markov states
  std::vector<double> gain_;                                  // samples x states, time-varying
  std::vector<double> innovation_sigma_;
};

// Generalised-least-squares visibility of a column in sigma: the norm of the whitened column after projecting
// out the constant and the `others`. An effect of this size has a coefficient of so many standard errors.
// Each capture has its own constant.
class Visibility {
 public:
  Visibility(std::shared_ptr<const NoiseModel> noise, int captures)
      : noise_(std::move(noise)), captures_(captures) {}
  using Column = std::vector<std::vector<double>>;  // by capture
  [[nodiscard]] double of(const Column& column, const std::vector<Column>& others) const;

 private:
  [[nodiscard]] std::vector<double> whitened(const Column& column) const;
  std::shared_ptr<const NoiseModel> noise_;  // of each capture
  int captures_;
};

}  // namespace ifog::undeclared
