// SPDX-License-Identifier: Apache-2.0
#include "filters/population/two_groups.h"

#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "filters/population/random_effects.h"

namespace ifog {
namespace {

constexpr int kMostRounds = 2000;
constexpr int kRoundsWithout = 200;  // from the fit of all, which one member hardly moves
constexpr double kSettled = 1e-8;    // change of the log-likelihood
constexpr double kSettledWithout = 1e-5;
// One member for and one against the effect, so that neither group is ever ruled out.
constexpr double kBeforehand = 1.0;

double square(double x) { return x * x; }

// Logarithm of the ratio of the likelihoods with and without the effect.
double log_ratio(const TypePrior& prior, const Estimate& estimate) {
  const double own = square(estimate.std_error);
  const double all = own + square(prior.spread);
  return 0.5 *
         (std::log(own / all) + square(estimate.value) / own - square(estimate.value - prior.mean) / all);
}

double log_sum(const TypePrior& prior, double ratio) {
  const double with = std::log(prior.share) + ratio, without = std::log1p(-prior.share);
  const double most = std::max(with, without);
  return most + std::log(std::exp(with - most) + std::exp(without - most));
}

// Of the members but `left_out`, over that of nobody having it.
double log_likelihood(const TypePrior& prior, std::span<const Estimate> estimates, std::size_t left_out) {
  double sum = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i)
    if (i != left_out) sum += log_sum(prior, log_ratio(prior, estimates[i]));
  return sum;
}

TypePrior improved(const TypePrior& prior, std::span<const Estimate> estimates, std::size_t left_out) {
  double members = 0.0, having = 0.0, sum = 0.0;
  std::vector<double> weight(estimates.size(), 0.0);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (i == left_out) continue;
    members += 1.0;
    weight[i] = probability(prior, estimates[i]);
    having += weight[i];
    const double own = square(estimates[i].std_error), type = square(prior.spread);
    sum += weight[i] * (type * estimates[i].value + own * prior.mean) / (own + type);
  }
  TypePrior next = prior;
  next.share = (having + kBeforehand) / (members + 2.0 * kBeforehand);
  if (having < 1e-6) return next;
  next.mean = sum / having;
  double variance = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const double own = square(estimates[i].std_error), type = square(prior.spread);
    const double expected = (type * estimates[i].value + own * prior.mean) / (own + type);
    variance += weight[i] * (square(expected - next.mean) + own * type / (own + type));
  }
  next.spread = std::sqrt(variance / having);
  return next;
}

TypePrior climbed(TypePrior prior, std::span<const Estimate> estimates, std::size_t left_out, int rounds,
                  double settled) {
  double before = log_likelihood(prior, estimates, left_out);
  for (int round = 0; round < rounds; ++round) {
    prior = improved(prior, estimates, left_out);
    const double now = log_likelihood(prior, estimates, left_out);
    if (std::abs(now - before) < settled) break;
    before = now;
  }
  prior.likelihood_ratio = 2.0 * log_likelihood(prior, estimates, left_out);
  double information = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i)
    if (i != left_out)
      information +=
          probability(prior, estimates[i]) / (square(estimates[i].std_error) + square(prior.spread));
  prior.mean_std_error = information > 0.0 ? std::sqrt(1.0 / information) : 0.0;
  return prior;
}

double normal_above(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

}  // namespace

TypePrior fit_two_groups(std::span<const Estimate> estimates) {
  const RandomEffects all = random_effects(estimates);
  double largest = 0.0;
  for (const Estimate& each : estimates)
    if (std::abs(each.value) > std::abs(largest)) largest = each.value;
  double error = 0.0;
  for (const Estimate& each : estimates) error += each.std_error / static_cast<double>(estimates.size());
  // The likelihood has more than one top: everybody alike, a few that are far out, either sign.
  const TypePrior starts[] = {{0.9, all.mean, 0.0, std::max(all.spread, 0.3 * error), 0.0},
                              {0.5, 0.5 * largest, 0.0, 0.25 * std::abs(largest) + 0.3 * error, 0.0},
                              {0.5, 0.0, 0.0, std::max(all.spread, error), 0.0}};
  TypePrior best;
  best.likelihood_ratio = -1e300;
  for (const TypePrior& start : starts) {
    const TypePrior found = climbed(start, estimates, estimates.size(), kMostRounds, kSettled);
    if (found.likelihood_ratio > best.likelihood_ratio) best = found;
  }
  return best;
}

TypePrior without_member(std::span<const Estimate> estimates, std::size_t member, const TypePrior& all) {
  if (estimates.size() < 2) throw std::invalid_argument("a population without other members");
  return climbed(all, estimates, member, kRoundsWithout, kSettledWithout);
}

double probability(const TypePrior& prior, const Estimate& estimate) {
  const double ratio = log_ratio(prior, estimate);
  return std::exp(std::log(prior.share) + ratio - log_sum(prior, ratio));
}

double chance_without(const TypePrior& prior, const Estimate& estimate) {
  // The ratio of the likelihoods is a parabola in the estimate; it is as large outside an interval about its
  // lowest point, and where there is no spread on one side of a line.
  const double own = square(estimate.std_error), type = square(prior.spread);
  const double sign = prior.mean < 0.0 ? -1.0 : 1.0;
  if (type < 1e-12 * own) return normal_above(sign * estimate.value / estimate.std_error);
  const double lowest = -prior.mean * own / type;
  const double away = std::abs(estimate.value - lowest);
  return normal_above((lowest + away) / estimate.std_error) +
         normal_above(-(lowest - away) / estimate.std_error);
}

Estimate shrunk(const TypePrior& prior, const Estimate& estimate) {
  const double own = square(estimate.std_error), type = square(prior.spread);
  const double to_mean = own / (own + type);
  return {estimate.value + to_mean * (prior.mean - estimate.value),
          std::sqrt(own * type / (own + type) + square(to_mean * prior.mean_std_error))};
}

}  // namespace ifog
