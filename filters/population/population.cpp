// SPDX-License-Identifier: Apache-2.0
#include "filters/population/population.h"

#include <algorithm>
#include <cmath>
#include <span>

#include "filters/distributions/chi_squared.h"

namespace ifog {
namespace {

// Factor of the chance level. Errors of single gyros are estimates, and slow noise has few independent
// pieces. Of 140 simulated gyros without the effect 1.4 % were beyond the 1 % level, 5.0 % beyond 5 %, 10.7 %
// beyond 10 % (tests/bench/fleet/results.md).
constexpr double kCare = 2.0;

void fill_in_means(TypeEffect& effect) {
  if (effect.effect.parameters.empty()) return;
  effect.effect.parameters.front().value = effect.prior.mean;
  effect.effect.parameters.front().std_error = effect.prior.mean_std_error;
}

// Members that have the effect but are outliers among those; one of them would dominate the spread.
std::vector<bool> standing_apart(std::span<const Estimate> estimates, const TypePrior& prior) {
  std::vector<double> having;
  for (const Estimate& each : estimates)
    if (probability(prior, each) > 0.5) having.push_back(each.value);
  std::vector<bool> apart(estimates.size(), false);
  if (having.size() < kFewestOfType) return apart;
  const RobustSpread spread = robust_spread(having);
  for (std::size_t i = 0; i < estimates.size(); ++i)
    apart[i] = probability(prior, estimates[i]) > 0.5 &&
               std::abs(estimates[i].value - spread.median) >
                   kStandsOut * std::hypot(spread.sigma, estimates[i].std_error);
  return apart;
}

}  // namespace

void judge(TypeEffect& effect, double level) {
  std::vector<Estimate> estimates;
  std::vector<EffectInGyro*> measured;
  effect.found_alone = effect.found = 0;
  for (EffectInGyro& each : effect.gyros) {
    effect.found_alone += each.found_alone ? 1 : 0;
    if (!each.own) continue;
    estimates.push_back(*each.own);
    measured.push_back(&each);
  }
  if (estimates.size() < 2) return;
  const TypePrior with_all = fit_two_groups(estimates);
  const std::vector<bool> apart = standing_apart(estimates, with_all);
  std::vector<Estimate> typical;
  for (std::size_t i = 0; i < estimates.size(); ++i)
    if (!apart[i]) typical.push_back(estimates[i]);
  effect.set_aside = estimates.size() - typical.size();
  effect.prior = effect.set_aside > 0 ? fit_two_groups(typical) : with_all;
  effect.all = random_effects(estimates);
  fill_in_means(effect);
  for (std::size_t i = 0, of_typical = 0; i < estimates.size(); ++i) {
    EffectInGyro& each = *measured[i];
    // An outlier belongs to the type only with a wide spread; the others' prior would shift it to their mean.
    each.others = apart[i] ? with_all : without_member(typical, of_typical++, effect.prior);
    each.probability = probability(each.others, estimates[i]);
    each.chance = chance_without(each.others, estimates[i]);
    each.found = kCare * each.chance <= level && each.probability > 0.5;
    effect.found += each.found ? 1 : 0;
  }
}

bool is_of_type(const TypePrior& prior, double level) {
  constexpr double kNumbers = 3.0;  // share, mean, spread
  return prior.likelihood_ratio > chi_squared_exceeded(level, kNumbers);
}

void describe(PopulationParameter& parameter) {
  std::vector<double> values, errors;
  std::vector<Estimate> with_errors;
  for (const Estimate& each : parameter.values) {
    values.push_back(parameter.logarithmic ? std::log(each.value) : each.value);
    errors.push_back(parameter.logarithmic ? each.std_error / each.value : each.std_error);
    if (each.std_error > 0.0) with_errors.push_back({values.back(), errors.back()});
  }
  parameter.z = robust_z(values, errors);
  parameter.robust = robust_spread(values);
  parameter.spread.reset();
  if (with_errors.size() >= 2 && with_errors.size() == values.size())
    parameter.spread = random_effects(with_errors);
}

std::vector<StandingOut> standing_out(const std::vector<PopulationParameter>& parameters) {
  std::vector<StandingOut> found;
  for (std::size_t p = 0; p < parameters.size(); ++p) {
    if (parameters[p].values.size() < kFewestOfType) continue;
    for (std::size_t i = 0; i < parameters[p].z.size(); ++i)
      if (std::abs(parameters[p].z[i]) > kStandsOut)
        found.push_back({parameters[p].gyros[i], p, parameters[p].z[i]});
  }
  std::ranges::stable_sort(
      found, [](const StandingOut& a, const StandingOut& b) { return std::abs(a.z) > std::abs(b.z); });
  return found;
}

}  // namespace ifog
