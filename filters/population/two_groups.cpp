// SPDX-License-Identifier: Apache-2.0
#include "filters/population/two_groups.h"

#include <Eigen/Core>
#include <algorithm>
#include <cmath>
#include <stdexcept>
#include <utility>
#include <vector>

namespace ifog {
namespace {

using Eigen::ArrayXd;

constexpr int kMostRounds = 2000;
constexpr double kSettled = 1e-6;  // change of the log-likelihood
// Prior: one member with and one without the effect, so neither group is excluded.
constexpr double kBeforehand = 1.0;
constexpr double kFewestHaving = 3.0;  // fewest members with the effect for an expected spread
constexpr Eigen::Index kSpreads = 60;  // number tried

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

// The estimates by column.
struct Members {
  std::span<const Estimate> estimates;
  ArrayXd value, own;  // own: squared standard errors

  explicit Members(std::span<const Estimate> of) : estimates(of), value(std::ssize(of)), own(std::ssize(of)) {
    std::ranges::transform(of, value.begin(), &Estimate::value);
    std::ranges::transform(of, own.begin(), [](const Estimate& each) { return square(each.std_error); });
  }

  // Relative to that without the effect.
  [[nodiscard]] double log_likelihood(const TypePrior& prior) const {
    double sum = 0.0;
    for (const Estimate& each : estimates) sum += log_sum(prior, log_ratio(prior, each));
    return sum;
  }
  // Probability of the effect, by member.
  [[nodiscard]] ArrayXd weights(const TypePrior& prior) const {
    ArrayXd weight(value.size());
    std::ranges::transform(estimates, weight.begin(),
                           [&](const auto& each) { return probability(prior, each); });
    return weight;
  }
};

// Standard error of the type's mean.
double error_of_mean(const Members& members, const ArrayXd& weight, double spread) {
  const double information = (weight / (members.own + square(spread))).sum();
  return information > 0.0 ? std::sqrt(1.0 / information) : 0.0;
}

TypePrior improved(const TypePrior& prior, const Members& members) {
  const ArrayXd weight = members.weights(prior);
  const double having = weight.sum(), type = square(prior.spread);
  TypePrior next = prior;
  next.share = (having + kBeforehand) / (static_cast<double>(weight.size()) + 2.0 * kBeforehand);
  if (having < 1e-6) return next;
  const ArrayXd all = members.own + type, expected = (type * members.value + members.own * prior.mean) / all;
  next.mean = (weight * expected).sum() / having;
  next.spread =
      std::sqrt((weight * ((expected - next.mean).square() + members.own * type / all)).sum() / having);
  return next;
}

TypePrior climbed(TypePrior prior, const Members& members) {
  double now = members.log_likelihood(prior), before = now - 1.0;
  for (int round = 0; round < kMostRounds && std::abs(now - before) >= kSettled; ++round) {
    prior = improved(prior, members);
    before = std::exchange(now, members.log_likelihood(prior));
  }
  prior.likelihood_ratio = 2.0 * now;
  prior.mean_std_error = error_of_mean(members, members.weights(prior), prior.spread);
  return prior;
}

// Restricted log-likelihood of a spread; members weighted by their probability of the effect.
double restricted(double spread, const Members& members, const ArrayXd& weight) {
  const ArrayXd variance = members.own + square(spread);
  const double information = (weight / variance).sum();
  const double mean = (weight * members.value / variance).sum() / information;
  return -0.5 * (std::log(information) +
                 (weight * (variance.log() + (members.value - mean).square() / variance)).sum());
}

TypePrior with_expected_spread(TypePrior prior, const Members& members) {
  prior.likeliest_spread = prior.spread;
  const ArrayXd weight = members.weights(prior);
  const double having = weight.sum();
  if (having < kFewestHaving) return prior;
  // Beyond, single errors are negligible and the likelihood falls as a power of the spread.
  const double most = 4.0 * (prior.spread + std::sqrt((weight * members.own).sum() / having));
  const ArrayXd spread = most * (ArrayXd::LinSpaced(kSpreads, 0.0, kSpreads - 1.0) + 0.5) / kSpreads;
  const ArrayXd likelihood = spread.unaryExpr([&](double each) { return restricted(each, members, weight); });
  const ArrayXd share = (likelihood - likelihood.maxCoeff()).exp();
  prior.spread = std::sqrt((share * spread.square()).sum() / share.sum());
  prior.mean_std_error = error_of_mean(members, weight, prior.spread);
  return prior;
}

double normal_above(double z) { return 0.5 * std::erfc(z / std::sqrt(2.0)); }

}  // namespace

TypePrior likeliest_two_groups(std::span<const Estimate> estimates) {
  const RandomEffects all = random_effects(estimates);
  const double largest =
      std::ranges::max(estimates, {}, [](const Estimate& each) { return std::abs(each.value); }).value;
  const Members members(estimates);
  const double error = members.own.sqrt().mean();
  // The likelihood has several maxima: all alike, a few outliers, either sign.
  const TypePrior found[] = {
      climbed({.share = 0.9, .mean = all.mean, .spread = std::max(all.spread, 0.3 * error)}, members),
      climbed({.share = 0.5, .mean = 0.5 * largest, .spread = 0.25 * std::abs(largest) + 0.3 * error},
              members),
      climbed({.share = 0.5, .spread = std::max(all.spread, error)}, members)};
  return std::ranges::max(found, {}, &TypePrior::likelihood_ratio);
}

TypePrior fit_two_groups(std::span<const Estimate> estimates) {
  return with_expected_spread(likeliest_two_groups(estimates), Members(estimates));
}

TypePrior without_member(std::span<const Estimate> estimates, std::size_t member, const TypePrior& all) {
  if (estimates.size() < 2) throw std::invalid_argument("a population without other members");
  std::vector<Estimate> others(estimates.begin(), estimates.end());
  others.erase(others.begin() + static_cast<std::ptrdiff_t>(member));
  const Members members(others);
  TypePrior start = all;  // which one member hardly changes
  start.spread = all.likeliest_spread;
  return with_expected_spread(climbed(start, members), members);
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
