// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/fleet_json.h"

#include <cmath>

#include "tools/ifog/fleet/results.h"

namespace ifog::tools {
namespace {

using Json = nlohmann::ordered_json;

Json number(double value) { return std::isfinite(value) ? Json(value) : Json(nullptr); }

Json estimate_json(const std::optional<Estimate>& estimate) {
  if (!estimate) return nullptr;
  return {{"value", number(estimate->value)}, {"std_error", number(estimate->std_error)}};
}

Json spread_json(const RandomEffects& spread) {
  return {{"method", "DerSimonian-Laird"},        {"gyros", spread.count},
          {"mean", number(spread.mean)},          {"mean_std_error", number(spread.mean_std_error)},
          {"spread", number(spread.spread)},      {"q", number(spread.q)},
          {"i_squared", number(spread.i_squared)}};
}

Json gyro_json(const Population& population, const EffectInGyro& each) {
  return {{"serial", population.serials[each.gyro]},
          {"own", estimate_json(each.own)},
          {"not_measured", each.not_measured.empty() ? Json(nullptr) : Json(each.not_measured)},
          {"likelihood_ratio", number(each.likelihood_ratio)},
          {"found_alone", each.found_alone},
          {"probability", number(each.probability)},
          {"chance", number(each.chance)},
          {"found", each.found},
          {"with_prior", estimate_json(each.with_prior)}};
}

Json type_effect_json(const Population& population, const TypeEffect& effect) {
  Json json = effect_json(effect.effect);
  json["found_alone"] = effect.found_alone;
  json["found"] = effect.found;
  json["prior"] = {{"share", number(effect.prior.share)},
                   {"mean", number(effect.prior.mean)},
                   {"mean_std_error", number(effect.prior.mean_std_error)},
                   {"spread", number(effect.prior.spread)},
                   {"likeliest_spread", number(effect.prior.likeliest_spread)},
                   {"likelihood_ratio", number(effect.prior.likelihood_ratio)}};
  json["set_aside"] = effect.set_aside;
  json["all"] = spread_json(effect.all);
  json["gyros"] = Json::array();
  for (const EffectInGyro& each : effect.gyros) json["gyros"].push_back(gyro_json(population, each));
  return json;
}

Json parameter_json(const Population& population, const PopulationParameter& parameter) {
  Json json = {{"name", parameter.name},
               {"axis", parameter.axis},
               {"unit", parameter.unit},
               {"of_logarithm", parameter.logarithmic},
               {"median", number(parameter.robust.median)},
               {"robust_sigma", number(parameter.robust.sigma)},
               {"spread", parameter.spread ? spread_json(*parameter.spread) : Json(nullptr)},
               {"gyros", Json::array()}};
  for (std::size_t i = 0; i < parameter.gyros.size(); ++i)
    json["gyros"].push_back({{"serial", population.serials[parameter.gyros[i]]},
                             {"value", number(parameter.values[i].value)},
                             {"std_error", number(parameter.values[i].std_error)},
                             {"robust_z", number(parameter.z[i])}});
  return json;
}

}  // namespace

Json fleet_json(const Population& population) {
  Json json = {{"schema", "ifog.fleet/1"},
               {"type", population.type},
               {"significance", population.significance},
               {"gyros", population.serials},
               {"failed", Json::array()},
               {"effects", Json::array()},
               {"parameters", Json::array()},
               {"standing_out", Json::array()},
               {"own_effects", Json::array()},
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
                                    {"robust_z", number(each.z)}});
  }
  for (const FoundInGyro& each : population.own) {
    Json effect = effect_json(each.effect);
    effect["serial"] = population.serials[each.gyro];
    json["own_effects"].push_back(std::move(effect));
  }
  return json;
}

}  // namespace ifog::tools
