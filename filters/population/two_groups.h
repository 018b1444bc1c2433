// SPDX-License-Identifier: Apache-2.0
// Population of which a share has an effect: empirical Bayes in the two-group model (Efron, Large-Scale
// Inference, 2010, chapter 2; shrinkage: Morris, JASA 78 (1983) 47-55). An estimate is normal about the
// member's coefficient with its standard error. The coefficient is zero, or normal with the type's mean and
// spread.
#pragma once

#include <cstddef>
#include <span>

#include "filters/population/random_effects.h"

namespace ifog {

struct TypePrior {
  double share = 0.0;                       // members that have the effect, within (0, 1)
  double mean = 0.0, mean_std_error = 0.0;  // of their coefficient
  double spread = 0.0;                      // standard deviation between members
  double likelihood_ratio = 0.0;  // twice the log-likelihood / that without the effect in any member
  double likeliest_spread = 0.0;
};

// Maximum likelihood by expectation maximisation; for the share, one member with and one without the effect
// are added. Throws std::invalid_argument as random_effects() does.
TypePrior likeliest_two_groups(std::span<const Estimate> estimates);

// The same with the expected instead of the most likely spread, which is zero if a few members agree by
// chance and makes intervals too narrow. Root of the expected square, by the restricted likelihood with a
// flat prior (Gelman, Bayesian Analysis 1 (2006) 515-533).
TypePrior fit_two_groups(std::span<const Estimate> estimates);

// The same without one member, i.e. the prior from the others. all: fit of all members.
TypePrior without_member(std::span<const Estimate> estimates, std::size_t member, const TypePrior& all);

// Posterior probability of the effect in a member with this estimate.
double probability(const TypePrior& prior, const Estimate& estimate);

// Probability that a member without the effect has an estimate with at least this likelihood ratio, which
// includes the type's sign and size.
double chance_without(const TypePrior& prior, const Estimate& estimate);

}  // namespace ifog
