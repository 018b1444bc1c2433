// SPDX-License-Identifier: Apache-2.0
// A rate random walk that returns: exponentially correlated (first-order Gauss-Markov) noise, IEEE Std 952
// annex C. At times short against its correlation time it is a random walk of the same K; its deviation is
// highest at 1.89 correlation times and falls beyond as white noise's does, where the walk's would continue
// rising.
//
// Found by the likelihood of noise_likelihood.h with the walk's column exchanged for its own: against all
// terms of IEEE Std 952 together one parameter more, which is infinite for the walk.
#pragma once

#include <optional>
#include <vector>

#include "filters/allan/noise/noise_likelihood.h"

namespace ifog {

// Everything in samples. The walk's place (kK) in variances is the driving noise's.
struct GaussMarkovFit {
  double correlation = 0.0, lower = 0.0, upper = 0.0;  // samples; 95 % by the profile of the likelihood
  TermVariances variances{};                           // the likeliest, at that
  double gain = 0.0;        // twice the log-likelihood gained over all terms with a walk
  bool present = false;     // named: falsely in less than 1 % of records
  bool weighed = false;     // to be weighed in what is foretold
  std::size_t samples = 0;  // of the longest stretch
  Ramp ramp = Ramp::kNone;
};

// With the walk's column that of a driving noise whose rate returns with this time constant, samples.
[[nodiscard]] NoiseSpectrum with_return(const NoiseSpectrum& spectrum, double correlation);

// samples: of the longest stretch; terms: the likeliest with a walk. ramp: kNone tells a return best, where
// the record shows no ramp; kProjected where it does. Nothing where no correlation time is likelier.
[[nodiscard]] std::optional<GaussMarkovFit> fit_gauss_markov(const NoiseSpectrum& spectrum, Ramp ramp,
                                                             std::size_t samples, const TermVariances& terms);

// What the record allows it to be, with all else at its likeliest: weights sum to one.
struct GaussMarkovChance {
  double weight = 0.0, correlation = 0.0;
  TermVariances variances{};
};
[[nodiscard]] std::vector<GaussMarkovChance> gauss_markov_chances(const NoiseSpectrum& spectrum,
                                                                  const GaussMarkovFit& fit);

// Allan variance after m samples for one unit of driving noise, and the same of a walk: m/3.
[[nodiscard]] double returning_variance(double correlation, double m);
// White noise and a walk that have, at m, the variance and the slope of this: where it is one or the other,
// that.
[[nodiscard]] TermVariances equivalent_terms(const GaussMarkovFit& fit, double m);

}  // namespace ifog
