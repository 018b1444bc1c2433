// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/fleet/results.h"

namespace ifog::tools {

nlohmann::ordered_json effect_json(const Effect& effect) {
  nlohmann::ordered_json json = {{"axis", effect.axis},
                                 {"form", effect.form},
                                 {"channel", effect.channel},
                                 {"with_form", effect.with_form},
                                 {"with_channel", effect.with_channel},
                                 {"reference", effect.reference},
                                 {"with_reference", effect.with_reference},
                                 {"period", effect.period},
                                 {"meaning", effect.meaning}};
  json["parameters"] = nlohmann::ordered_json::array();
  for (const ModelParameter& each : effect.parameters)
    json["parameters"].push_back(
        {{"name", each.name}, {"value", each.value}, {"std_error", each.std_error}, {"unit", each.unit}});
  return json;
}

Effect effect_of(const nlohmann::json& json) {
  Effect effect;
  effect.axis = json.at("axis").get<std::string>();
  effect.form = json.at("form").get<std::string>();
  effect.channel = json.at("channel").get<std::string>();
  effect.with_form = json.at("with_form").get<std::string>();
  effect.with_channel = json.at("with_channel").get<std::string>();
  effect.reference = json.at("reference").get<double>();
  effect.with_reference = json.at("with_reference").get<double>();
  effect.period = json.at("period").get<double>();
  effect.meaning = json.at("meaning").get<std::string>();
  for (const nlohmann::json& each : json.at("parameters"))
    effect.parameters.push_back({each.at("name").get<std::string>(), each.at("value").get<double>(),
                                 each.at("std_error").get<double>(), each.at("unit").get<std::string>()});
  return effect;
}

}  // namespace ifog::tools
