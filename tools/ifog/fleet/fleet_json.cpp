// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/fleet_json.h"

#include "tools/ifog/console/json.h"
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

template <typename Io, Is<Estimate> T>
void fields(Io& io, T& of) {
  io("value", of.value);
  io("std_error", of.std_error);
}
template <typename Io, Is<RandomEffects> T>
void fields(Io& io, T& of) {
  io("gyros", of.count);
  io("mean", of.mean);
  io("mean_std_error", of.mean_std_error);
  io("spread", of.spread);
  io("q", of.q);
  io("i_squared", of.i_squared);
}
template <typename Io, Is<TypePrior> T>
void fields(Io& io, T& of) {
  io("share", of.share);
  io("mean", of.mean);
  io("mean_std_error", of.mean_std_error);
  io("spread", of.spread);
  io("likeliest_spread", of.likeliest_spread);
  io("likelihood_ratio", of.likelihood_ratio);
}

namespace {

using Json = nlohmann::ordered_json;

Json spread_json(const RandomEffects& spread) {
  Json json{{"method", "DerSimonian-Laird"}};
  json.update(as_json(spread));
  return json;
}

Json gyro_json(const Population& population, const EffectInGyro& each) {
  return {{"serial", population.serials[each.gyro]},
          {"own", as_json(each.own)},
          {"not_measured", each.not_measured.empty() ? Json(nullptr) : Json(each.not_measured)},
          {"likelihood_ratio", each.likelihood_ratio},
          {"found_alone", each.found_alone},
          {"probability", each.probability},
          {"chance", each.chance},
          {"found", each.found},
          {"with_prior", as_json(each.with_prior)}};
}

Json type_effect_json(const Population& population, const TypeEffect& effect) {
  Json json = as_json(effect.effect);
  json["found_alone"] = effect.found_alone;
  json["found"] = effect.found;
  json["prior"] = as_json(effect.prior);
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
               {"median", parameter.robust.median},
               {"robust_sigma", parameter.robust.sigma},
               {"spread", parameter.spread ? spread_json(*parameter.spread) : Json(nullptr)},
               {"gyros", Json::array()}};
  for (std::size_t i = 0; i < parameter.gyros.size(); ++i)
    json["gyros"].push_back({{"serial", population.serials[parameter.gyros[i]]},
                             {"value", parameter.values[i].value},
                             {"std_error", parameter.values[i].std_error},
                             {"robust_z", parameter.z[i]}});
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
                                    {"robust_z", each.z}});
  }
  for (const FoundInGyro& each : population.own) {
    Json effect = as_json(each.effect);
    effect["serial"] = population.serials[each.gyro];
    json["own_effects"].push_back(std::move(effect));
  }
  return json;
}

}  // namespace ifog::tools
