// SPDX-License-Identifier: Apache-2.0
// A population of which a share has an effect and the rest does not, and what that says of one member:
// empirical Bayes in the two-group model (Efron, Large-Scale Inference, 2010, chapter 2; Morris, JASA 78
// (1983) 47-55 for the shrinkage). An estimate is normal about the member's own coefficient with its standard
// error; the coefficient is zero, or normal about the type's mean with the type's spread.
#pragma once

#include <cstddef>
#include <span>

#include "filters/population/estimate.h"

namespace ifog {

struct TypePrior {
  double share = 0.0;                       // of the members that have the effect, within (0, 1)
  double mean = 0.0, mean_std_error = 0.0;  // of the coefficient of those
  double spread = 0.0;                      // standard deviation from member to member
  double likelihood_ratio = 0.0;            // twice the log-likelihood over that of nobody having it
  double likeliest_spread = 0.0;
};

// Maximum likelihood by expectation and maximisation, the share with one member for and one against it besides
// those there are. Throws std::invalid_argument as random_effects() does.
TypePrior likeliest_two_groups(std::span<const Estimate> estimates);

// The same with the spread that is expected, not the likeliest: a few members that happen to lie together
// have a likeliest spread of zero, and intervals that believe it are too narrow. The root of its expected
// square, by the restricted likelihood and before the data as likely at one size as at another (Gelman,
// Bayesian Analysis 1 (2006) 515-533).
TypePrior fit_two_groups(std::span<const Estimate> estimates);

// The same again without one member: what the others say of it. `all`: the fit of all of them.
TypePrior without_member(std::span<const Estimate> estimates, std::size_t member, const TypePrior& all);

// Probability that a member with this estimate has the effect.
double probability(const TypePrior& prior, const Estimate& estimate);

// Chance that a member without the effect has an estimate that speaks for it as much (by the ratio of the two
// likelihoods, which takes in sign and size that the type has).
double chance_without(const TypePrior& prior, const Estimate& estimate);

}  // namespace ifog
