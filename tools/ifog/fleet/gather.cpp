// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/gather.h"

#include <algorithm>
#include <array>
#include <set>

#include "drivers/capture/files/input_file.h"
#include "tools/ifog/console/json.h"
#include "tools/ifog/fleet/gyro_work.h"
#include "tools/ifog/fleet/results.h"

namespace ifog {
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(Estimate, value, std_error)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(TypePrior, share, mean, mean_std_error, spread, likeliest_spread,
                                   likelihood_ratio)
NLOHMANN_DEFINE_TYPE_NON_INTRUSIVE(EffectInGyro, own, not_measured, likelihood_ratio, found_alone,
                                   probability, chance, found, with_prior)
}  // namespace ifog

namespace ifog::tools {
namespace {

// Twice the log-likelihood by which another form must be better, over all gyros.
constexpr double kBetterForm = 6.0;

struct NoiseKey {
  const char *name, *key, *unit;
};
constexpr std::array<NoiseKey, 5> kNoiseKeys{{{"Q", "Q_rad", "rad"},
                                              {"N", "N_radps_rthz", "rad/s/rtHz"},
                                              {"B", "B_radps", "rad/s"},
                                              {"K", "K_radps2_rthz", "rad/s2/rtHz"},
                                              {"R", "R_radps2", "rad/s2"}}};

// "noise" of a diagnosis is that of one axis, or an object by axis.
void add_noise(const nlohmann::json& noise, const std::string& axis, std::size_t gyro,
               std::map<std::pair<std::string, std::string>, PopulationParameter>& found) {
  for (const NoiseKey& term : kNoiseKeys) {
    const auto value = noise.find(term.key);
    if (value == noise.end() || !value->is_number() || !(value->get<double>() > 0.0)) continue;
    PopulationParameter& parameter = found[{axis, term.name}];
    parameter.name = term.name;
    parameter.axis = axis;
    parameter.unit = term.unit;
    parameter.logarithmic = true;
    double error = 0.0;
    if (const auto errors = noise.find("std_error"); errors != noise.end() && errors->contains(term.key))
      if (const nlohmann::json& each = errors->at(term.key); each.is_number()) error = each.get<double>();
    parameter.gyros.push_back(gyro);
    parameter.values.push_back({value->get<double>(), std::max(error, 0.0)});
  }
}

// Noise of each axis for which the model contains it. Throws std::runtime_error with one line.
std::map<std::string, nlohmann::json> noise_by_axis(const std::string& path, const Model& model) {
  try {
    const nlohmann::json noise = parse_json(read_whole_file(path), path).at("noise");
    const bool single = model.noise.size() == 1;
    std::map<std::string, nlohmann::json> by_axis;
    for (const auto& [axis, terms] : model.noise) by_axis[axis] = single ? noise : noise.at(axis);
    return by_axis;
  } catch (const nlohmann::json::exception& error) {
    refuse_keys(path, error);
  }
}

const MeasuredEffect* measured_of(const GyroMeasured& gyro, std::size_t of_type) {
  for (const AxisMeasured& axis : gyro.axes)
    for (const EffectOfType& each : axis.together)
      if (each.of_type == of_type) return &each;
  return nullptr;
}

// Sums over the gyros that measured the first form.
std::vector<double> explained_by_form(const TypeCandidate& candidate, std::size_t of_type,
                                      const std::map<std::size_t, GyroMeasured>& measured) {
  std::vector<double> sums(candidate.forms.size(), 0.0);
  for (const auto& [gyro, all] : measured) {
    const MeasuredEffect* const each = measured_of(all, of_type);
    if (each == nullptr || !each->not_measured.empty()) continue;
    sums.front() += each->likelihood_ratio;
    for (std::size_t i = 0; i + 1 < sums.size() && i < each->instead.size(); ++i)
      sums[i + 1] += each->instead[i];
  }
  return sums;
}

nlohmann::json spread_json(const RandomEffects& spread) {
  return {{"method", "DerSimonian-Laird"}, {"gyros", spread.count},
          {"mean", spread.mean},           {"mean_std_error", spread.mean_std_error},
          {"spread", spread.spread},       {"q", spread.q},
          {"i_squared", spread.i_squared}};
}

nlohmann::json gyro_json(const Population& population, const EffectInGyro& each) {
  nlohmann::json json = each;
  json["serial"] = population.serials[each.gyro];
  if (each.not_measured.empty()) json["not_measured"] = nullptr;
  return json;
}

nlohmann::json type_effect_json(const Population& population, const TypeEffect& effect) {
  nlohmann::json json = effect.effect;
  json["found_alone"] = effect.found_alone;
  json["found"] = effect.found;
  json["prior"] = effect.prior;
  json["set_aside"] = effect.set_aside;
  json["all"] = spread_json(effect.all);
  json["gyros"] = nlohmann::json::array();
  for (const EffectInGyro& each : effect.gyros) json["gyros"].push_back(gyro_json(population, each));
  return json;
}

nlohmann::json parameter_json(const Population& population, const PopulationParameter& parameter) {
  nlohmann::json json = {
      {"name", parameter.name},
      {"axis", parameter.axis},
      {"unit", parameter.unit},
      {"of_logarithm", parameter.logarithmic},
      {"median", parameter.robust.median},
      {"robust_sigma", parameter.robust.sigma},
      {"spread", parameter.spread ? spread_json(*parameter.spread) : nlohmann::json(nullptr)},
      {"gyros", nlohmann::json::array()}};
  for (std::size_t i = 0; i < parameter.gyros.size(); ++i)
    json["gyros"].push_back({{"serial", population.serials[parameter.gyros[i]]},
                             {"value", parameter.values[i].value},
                             {"std_error", parameter.values[i].std_error},
                             {"robust_z", parameter.z[i]}});
  return json;
}

}  // namespace

Diagnosed gather_diagnosed(const Results& results, const Manifest& manifest, const std::string& options,
                           std::vector<Population::Failure>& failed) {
  Diagnosed diagnosed;
  for (std::size_t i = 0; i < manifest.gyros.size(); ++i) {
    const FleetGyro& gyro = manifest.gyros[i];
    if (!is_diagnosed(results, gyro, options)) continue;
    try {
      Model model = read_model(results.path(gyro, "model.toml"));
      diagnosed.noise[i] = noise_by_axis(results.path(gyro, "diagnosis.json"), model);
      for (const Effect& effect : model.effects) diagnosed.found.push_back({i, effect});
      diagnosed.gyros.push_back(i);
      diagnosed.models[i] = std::move(model);
    } catch (const std::exception& error) {  // from the file, the JSON or its numbers
      results.forget(gyro, "gyro.json");
      failed.push_back({i, std::string(error.what()) + "; the next run diagnoses it again"});
    }
  }
  return diagnosed;
}

std::vector<PopulationParameter> noise_parameters(const Diagnosed& diagnosed) {
  std::map<std::pair<std::string, std::string>, PopulationParameter> found;
  for (const std::size_t gyro : diagnosed.gyros)
    for (const auto& [axis, terms] : diagnosed.noise.at(gyro)) add_noise(terms, axis, gyro, found);
  std::vector<PopulationParameter> parameters;
  parameters.reserve(found.size());
  for (auto& [key, parameter] : found) parameters.push_back(std::move(parameter));
  return parameters;
}

std::map<std::size_t, GyroMeasured> gather_measured(const Results& results, const Manifest& manifest,
                                                    const std::string& options, const Diagnosed& diagnosed,
                                                    const TypeToMeasure& type,
                                                    std::vector<Population::Failure>& failed) {
  std::map<std::size_t, GyroMeasured> found;
  for (const std::size_t gyro : diagnosed.gyros) {
    std::optional<GyroMeasured> measured = results.measured(manifest.gyros[gyro], type.id);
    if (!measured || measured->inputs != identity_of(manifest.gyros[gyro], options))
      failed.push_back({gyro, "diagnosed, but the type's effects were not measured"});
    else if (measured->failed)
      failed.push_back({gyro, *measured->failed});
    else
      found[gyro] = std::move(*measured);
  }
  return found;
}

std::vector<TypeEffect> judged_effects(const TypeToMeasure& type,
                                       const std::map<std::size_t, GyroMeasured>& measured,
                                       const Diagnosed& diagnosed, double level) {
  std::vector<TypeEffect> effects;
  for (std::size_t i = 0; i < type.effects.size(); ++i) {
    TypeEffect effect;
    effect.effect = type.effects[i].forms.front();
    std::set<std::size_t> alone;
    for (const FoundInGyro& each : diagnosed.found)
      if (is_of(type.effects[i], each.effect)) alone.insert(each.gyro);
    for (const auto& [gyro, all] : measured) {
      EffectInGyro here;
      here.gyro = gyro;
      here.found_alone = alone.count(gyro) > 0;
      const MeasuredEffect* const each = measured_of(all, i);
      if (each == nullptr) {
        here.not_measured = "the gyro has no such axis";
      } else if (!each->not_measured.empty()) {
        here.not_measured = each->not_measured;
      } else {
        const ModelParameter& coefficient = each->effect.parameters.front();
        here.own = Estimate{coefficient.value, coefficient.std_error};
        here.likelihood_ratio = each->likelihood_ratio;
        effect.effect.parameters.front().unit = coefficient.unit;
        effect.effect.meaning = each->effect.meaning;
      }
      effect.gyros.push_back(std::move(here));
    }
    judge(effect, level / static_cast<double>(type.effects.size()));
    effects.push_back(std::move(effect));
  }
  return effects;
}

bool reconsider(TypeToMeasure& type, const std::vector<TypeEffect>& judged,
                const std::map<std::size_t, GyroMeasured>& measured, double level, bool forms_too) {
  if (type.effects.empty()) return false;
  bool changed = false;
  std::size_t weakest = type.effects.size();
  for (std::size_t i = 0; i < type.effects.size(); ++i) {
    std::vector<Effect>& forms = type.effects[i].forms;
    const std::vector<double> sums = explained_by_form(type.effects[i], i, measured);
    const auto best = static_cast<std::size_t>(std::ranges::max_element(sums) - sums.begin());
    if (forms_too && best > 0 && sums[best] > sums.front() + kBetterForm) {
      std::rotate(forms.begin(), forms.begin() + static_cast<std::ptrdiff_t>(best),
                  forms.begin() + static_cast<std::ptrdiff_t>(best) + 1);
      changed = true;
    }
    const double ratio = judged[i].prior.likelihood_ratio;
    if (is_of_type(judged[i].prior, level / static_cast<double>(type.effects.size()))) continue;
    if (weakest == type.effects.size() || ratio < judged[weakest].prior.likelihood_ratio) weakest = i;
  }
  if (weakest < type.effects.size() && !changed) {
    type.effects.erase(type.effects.begin() + static_cast<std::ptrdiff_t>(weakest));
    changed = true;
  }
  return changed;
}

std::vector<PopulationParameter> coefficient_parameters(const std::vector<TypeEffect>& effects) {
  std::vector<PopulationParameter> parameters;
  for (const TypeEffect& effect : effects) {
    PopulationParameter parameter;
    parameter.name =
        effect.effect.form + (effect.effect.channel.empty() ? "" : " of " + effect.effect.channel);
    parameter.axis = effect.effect.axis;
    parameter.unit = effect.effect.parameters.front().unit;
    for (const EffectInGyro& each : effect.gyros) {
      if (!each.own) continue;
      parameter.gyros.push_back(each.gyro);
      parameter.values.push_back(*each.own);
    }
    parameters.push_back(std::move(parameter));
  }
  return parameters;
}

nlohmann::json fleet_json(const Population& population) {
  nlohmann::json json = {{"schema", "ifog.fleet/1"},
                         {"type", population.type},
                         {"significance", population.significance},
                         {"gyros", population.serials},
                         {"failed", nlohmann::json::array()},
                         {"effects", nlohmann::json::array()},
                         {"parameters", nlohmann::json::array()},
                         {"standing_out", nlohmann::json::array()},
                         {"own_effects", nlohmann::json::array()},
                         {"remarks", population.remarks}};
  for (const Population::Failure& each : population.failed)
    json["failed"].push_back({{"serial", population.serials[each.gyro]}, {"why", each.why}});
  for (const TypeEffect& each : population.effects)
    json["effects"].push_back(type_effect_json(population, each));
  for (const PopulationParameter& each : population.parameters)
    json["parameters"].push_back(parameter_json(population, each));
  for (const StandingOut& each : population.standing_out) {
    const PopulationParameter& parameter = population.parameters[each.parameter];
    json["standing_out"].push_back({{"serial", population.serials[each.gyro]},
                                    {"parameter", parameter.name},
                                    {"axis", parameter.axis},
                                    {"robust_z", each.z}});
  }
  for (const FoundInGyro& each : population.own) {
    nlohmann::json effect = each.effect;
    effect["serial"] = population.serials[each.gyro];
    json["own_effects"].push_back(std::move(effect));
  }
  return json;
}

}  // namespace ifog::tools
