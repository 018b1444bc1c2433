// SPDX-License-Identifier: Apache-2.0
// First-order Gauss-Markov noise (exponentially correlated, IEEE Std 952 annex C): a rate random walk that
// returns. For τ far below its correlation time it is a random walk with the same K. Its deviation has a
// maximum at 1.89 correlation times and then falls like white noise.
//
// It is fitted by the likelihood of noise_likelihood.h, with the random walk's column replaced. Compared with
// all terms of IEEE Std 952 it has one more parameter, which is infinite for a random walk.
#pragma once

#include <optional>
#include <vector>

#include "filters/allan/noise/noise_likelihood.h"

namespace ifog {

// All in samples. Index kK of `variances` is the driving noise.
struct GaussMarkovFit {
  double correlation = 0.0, lower = 0.0, upper = 0.0;  // samples; 95 % profile likelihood interval
  TermVariances variances{};                           // most likely
  double gain = 0.0;        // of twice the log-likelihood, compared with all terms and a random walk
  bool present = false;     // detected; false in less than 1 % of records
  bool weighed = false;     // likely enough to be used in forecasts
  std::size_t samples = 0;  // of the longest stretch
  Ramp ramp = Ramp::kNone;
};

// Spectrum with the random walk's column replaced by Gauss-Markov noise of this correlation time (samples).
[[nodiscard]] NoiseSpectrum with_return(const NoiseSpectrum& spectrum, double correlation);

// nullopt if no correlation time fits better than a random walk. samples: length of the longest stretch;
// terms: most likely with a random walk. ramp: kNone detects best if the record has no ramp, else kProjected.
[[nodiscard]] std::optional<GaussMarkovFit> fit_gauss_markov(const NoiseSpectrum& spectrum, Ramp ramp,
                                                             std::size_t samples, const TermVariances& terms);

// One of the values that the record allows, the other parameters at their best; weights sum to one.
struct GaussMarkovChance {
  double weight = 0.0, correlation = 0.0;
  TermVariances variances{};
};
[[nodiscard]] std::vector<GaussMarkovChance> gauss_markov_chances(const NoiseSpectrum& spectrum,
                                                                  const GaussMarkovFit& fit);

// Allan variance after m samples for one unit of driving noise; that of a random walk is m/3.
[[nodiscard]] double returning_variance(double correlation, double m);
// White noise and random walk with the same Allan variance and slope at m, or only one of the two if the
// slope is beyond both.
[[nodiscard]] TermVariances equivalent_terms(const GaussMarkovFit& fit, double m);

}  // namespace ifog
