// SPDX-License-Identifier: Apache-2.0
#include "filters/population/two_groups.h"

#include <algorithm>
#include <array>
#include <cmath>
#include <stdexcept>
#include <vector>

#include "filters/population/random_effects.h"

namespace ifog {
namespace {

constexpr int kMostRounds = 2000;
constexpr int kRoundsWithout = 200;  // starting at the fit of all, which one member hardly changes
constexpr double kSettled = 1e-8;    // change of the log-likelihood
constexpr double kSettledWithout = 1e-5;
// Prior: one member with and one without the effect, so neither group is excluded.
constexpr double kBeforehand = 1.0;
constexpr double kFewestHaving = 3.0;  // fewest members with the effect for an expected spread
constexpr std::size_t kSpreads = 60;   // number tried

double square(double x) { return x * x; }

// Log-likelihood ratio with and without the effect.
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

// Log-likelihood without member `left_out`, relative to that without the effect.
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

// Restricted log-likelihood of a spread; members weighted by their probability of the effect.
double restricted(double spread, std::span<const Estimate> estimates, const std::vector<double>& weight) {
  double information = 0.0, weighted = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const double variance = square(estimates[i].std_error) + square(spread);
    information += weight[i] / variance;
    weighted += weight[i] * estimates[i].value / variance;
  }
  const double mean = weighted / information;
  double sum = -0.5 * std::log(information);
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    const double variance = square(estimates[i].std_error) + square(spread);
    sum -= 0.5 * weight[i] * (std::log(variance) + square(estimates[i].value - mean) / variance);
  }
  return sum;
}

TypePrior with_expected_spread(TypePrior prior, std::span<const Estimate> estimates, std::size_t left_out) {
  prior.likeliest_spread = prior.spread;
  std::vector<double> weight(estimates.size(), 0.0);
  double having = 0.0, errors = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i) {
    if (i == left_out) continue;
    weight[i] = probability(prior, estimates[i]);
    having += weight[i];
    errors += weight[i] * square(estimates[i].std_error);
  }
  if (having < kFewestHaving) return prior;
  // Beyond, single errors are negligible and the likelihood falls as a power of the spread.
  const double most = 4.0 * (prior.spread + std::sqrt(errors / having));
  std::array<double, kSpreads> likelihood{};
  for (std::size_t k = 0; k < kSpreads; ++k)
    likelihood[k] = restricted(most * (static_cast<double>(k) + 0.5) / kSpreads, estimates, weight);
  const double top = *std::ranges::max_element(likelihood);
  double sum = 0.0, squares = 0.0;
  for (std::size_t k = 0; k < kSpreads; ++k) {
    const double share = std::exp(likelihood[k] - top);
    sum += share;
    squares += share * square(most * (static_cast<double>(k) + 0.5) / kSpreads);
  }
  prior.spread = std::sqrt(squares / sum);
  double information = 0.0;
  for (std::size_t i = 0; i < estimates.size(); ++i)
    information += weight[i] / (square(estimates[i].std_error) + square(prior.spread));
  prior.mean_std_error = std::sqrt(1.0 / information);
  return prior;
}

double normal_above(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

}  // namespace

TypePrior likeliest_two_groups(std::span<const Estimate> estimates) {
  const RandomEffects all = random_effects(estimates);
  double largest = 0.0;
  for (const Estimate& each : estimates)
    if (std::abs(each.value) > std::abs(largest)) largest = each.value;
  double error = 0.0;
  for (const Estimate& each : estimates) error += each.std_error / static_cast<double>(estimates.size());
  // The likelihood has several maxima: all alike, a few outliers, either sign.
  const auto start_at = [](double share, double mean, double spread) {
    TypePrior start;
    start.share = share;
    start.mean = mean;
    start.spread = spread;
    return start;
  };
  const TypePrior starts[] = {start_at(0.9, all.mean, std::max(all.spread, 0.3 * error)),
                              start_at(0.5, 0.5 * largest, 0.25 * std::abs(largest) + 0.3 * error),
                              start_at(0.5, 0.0, std::max(all.spread, error))};
  TypePrior best;
  best.likelihood_ratio = -1e300;
  for (const TypePrior& start : starts) {
    const TypePrior found = climbed(start, estimates, estimates.size(), kMostRounds, kSettled);
    if (found.likelihood_ratio > best.likelihood_ratio) best = found;
  }
  return best;
}

TypePrior fit_two_groups(std::span<const Estimate> estimates) {
  return with_expected_spread(likeliest_two_groups(estimates), estimates, estimates.size());
}

TypePrior without_member(std::span<const Estimate> estimates, std::size_t member, const TypePrior& all) {
  if (estimates.size() < 2) throw std::invalid_argument("a population without other members");
  TypePrior start = all;
  start.spread = all.likeliest_spread;
  return with_expected_spread(climbed(start, estimates, member, kRoundsWithout, kSettledWithout), estimates,
                              member);
}

double probability(const TypePrior& prior, const Estimate& estimate) {
  const double ratio = log_ratio(prior, estimate);
  return std::exp(std::log(prior.share) + ratio - log_sum(prior, ratio));
}

double chance_without(const TypePrior& prior, const Estimate& estimate) {
  // The likelihood ratio is a parabola of the estimate. So it is as large outside an interval about its
  // minimum, or, without spread, on one side of a line.
  const double own = square(estimate.std_error), type = square(prior.spread);
  const double sign = prior.mean < 0.0 ? -1.0 : 1.0;
  if (type < 1e-12 * own) return normal_above(sign * estimate.value / estimate.std_error);
  const double lowest = -prior.mean * own / type;
  const double away = std::abs(estimate.value - lowest);
  return normal_above((lowest + away) / estimate.std_error) +
         normal_above(-(lowest - away) / estimate.std_error);
}

}  // namespace ifog
