// SPDX-License-Identifier: Apache-2.0
// The sensor's own noise with its exact state space, so that what an effect is worth against it can be
// computed by an oracle that knows the truth and shares no code with the diagnosis.
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

// White, random walk and 1/f, the last as a sum of Gauss-Markov processes a factor of 2.5 apart in time
// constant, from one sample to ten records: the one-sided density B^2 / (2 pi f) within 5 % up to a sixtieth
// of the sample rate. Above that the white noise hides it.
class NoiseModel {
 public:
  NoiseModel(const NoiseTruth& truth, std::size_t samples, double dt_s);

  // n samples that begin at a random-walk state of zero (the switch-on bias is added elsewhere).
  [[nodiscard]] std::vector<double> draw(Draw& draw) const;

  // The innovations of a column, each over its own standard deviation: unit white noise when the column is
  // this noise.
  [[nodiscard]] std::vector<double> whiten(const std::vector<double>& column) const;
  [[nodiscard]] double log_determinant() const;  // of the covariance of all samples

 private:
  std::size_t samples_;
  double white_sigma_, walk_sigma_;
  std::vector<double> decay_, drive_sigma_, start_variance_;  // of the Gauss-Markov states
  std::vector<double> gain_;                                  // samples x states, time-varying
  std::vector<double> innovation_sigma_;
};

// The generalised-least-squares visibility of a column in sigma: the norm of what is left of the whitened
// column once the constant and the `others` are projected out. An effect of this size moves its coefficient
// this many standard errors away from zero. Segments (several captures) have a constant each.
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
