// SPDX-License-Identifier: Apache-2.0
#include "filters/population/type_effects.h"

#include <algorithm>
#include <boost/math/distributions/binomial.hpp>
#include <cmath>
#include <map>
#include <optional>
#include <set>
#include <string>
#include <tuple>

#include "filters/effects/meaning.h"
#include "filters/model_file/form.h"

namespace ifog {
namespace {

constexpr std::size_t kMostForms = 4;
constexpr double kOftenTogether = 0.25;  // share of the gyros that show the rarer of two forms

bool can_be_of_a_type(const Effect& effect) {
  const std::optional<Form> form = form_named(effect.form);
  if (!form || effect.shown_only || !carries_over(*form)) return false;
  // Ageing and transitions are individual to each coil.
  return *form != Form::kLookup && *form != Form::kRebuiltRamp && *form != Form::kEarthRate &&
         *form != Form::kRateRamp && *form != Form::kTransition && *form != Form::kBias;
}

using Family = std::tuple<std::string, std::string, std::string>;  // axis, channels in order

Family family_of(const Effect& effect) {
  return {effect.axis, std::min(effect.channel, effect.with_channel),
          std::max(effect.channel, effect.with_channel)};
}

bool same_form(const Effect& a, const Effect& b) {
  return family_of(a) == family_of(b) && a.form == b.form && a.channel == b.channel &&
         a.with_form == b.with_form && a.period == b.period;
}

struct FormFound {
  Effect effect;                                       // of the first gyro
  std::set<std::size_t> gyros;                         // gyros that show it
  std::map<std::string, std::vector<double>> further;  // parameters except the coefficient
};

std::vector<FormFound> by_form(std::span<const FoundInGyro> found) {
  std::vector<FormFound> forms;
  for (const FoundInGyro& each : found) {
    if (!can_be_of_a_type(each.effect)) continue;
    auto at = std::ranges::find_if(
        forms, [&](const FormFound& form) { return same_form(form.effect, each.effect); });
    if (at == forms.end()) at = forms.insert(forms.end(), {each.effect, {}, {}});
    if (!at->gyros.insert(each.gyro).second) continue;
    for (const ModelParameter& parameter : each.effect.parameters)
      if (parameter.name != "coefficient") at->further[parameter.name].push_back(parameter.value);
  }
  std::ranges::stable_sort(
      forms, [](const FormFound& a, const FormFound& b) { return a.gyros.size() > b.gyros.size(); });
  return forms;
}

double geometric_median(std::vector<double> values) {
  std::ranges::sort(values);
  const std::size_t n = values.size();
  return n % 2 == 1 ? values[n / 2] : std::sqrt(values[n / 2 - 1] * values[n / 2]);
}

Effect typical(const FormFound& form) {
  Effect effect = form.effect;
  std::erase_if(effect.parameters, [](const ModelParameter& each) { return each.name != "coefficient"; });
  for (ModelParameter& each : effect.parameters) each.value = each.std_error = 0.0;
  for (const auto& [name, values] : form.further)
    if (2 * values.size() > form.gyros.size())
      effect.parameters.push_back({name, geometric_median(values), 0.0,
                                   name.ends_with("_s") ? "s" : std::string(unit_of(effect.channel))});
  return effect;
}

bool often_together(const FormFound& a, const FormFound& b) {
  std::size_t both = 0;
  for (const std::size_t gyro : a.gyros) both += b.gyros.count(gyro);
  const double rarer = static_cast<double>(std::min(a.gyros.size(), b.gyros.size()));
  return both >= 2 && static_cast<double>(both) >= kOftenTogether * rarer;
}

}  // namespace

std::size_t least_repeats(std::size_t gyros, double chance) {
  const boost::math::binomial_distribution<> wrong(static_cast<double>(gyros), chance);
  std::size_t least = 1;
  while (least <= gyros && cdf(complement(wrong, static_cast<double>(least) - 1.0)) > chance) ++least;
  return least;
}

std::vector<TypeCandidate> type_candidates(std::span<const FoundInGyro> found, std::size_t gyros,
                                           double significance) {
  std::vector<std::vector<FormFound>> groups;
  for (const FormFound& form : by_form(found)) {
    const auto stands_for = [&](const std::vector<FormFound>& group) {
      return family_of(group.front().effect) == family_of(form.effect) &&
             std::ranges::none_of(group, [&](const FormFound& other) { return often_together(other, form); });
    };
    const auto at = std::ranges::find_if(groups, stands_for);
    if (at == groups.end())
      groups.push_back({form});
    else
      at->push_back(form);
  }
  const std::size_t least = std::max<std::size_t>(2, least_repeats(gyros, significance));
  std::vector<TypeCandidate> candidates;
  for (const std::vector<FormFound>& group : groups) {
    TypeCandidate candidate;
    std::set<std::size_t> members;
    for (const FormFound& form : group) {
      members.insert(form.gyros.begin(), form.gyros.end());
      if (candidate.forms.size() < kMostForms) candidate.forms.push_back(typical(form));
    }
    candidate.found_in = members.size();
    if (candidate.found_in >= least) candidates.push_back(std::move(candidate));
  }
  std::ranges::stable_sort(
      candidates, [](const TypeCandidate& a, const TypeCandidate& b) { return a.found_in > b.found_in; });
  return candidates;
}

bool is_of(const TypeCandidate& candidate, const Effect& effect) {
  return std::ranges::any_of(candidate.forms, [&](const Effect& form) { return same_form(form, effect); });
}

}  // namespace ifog
