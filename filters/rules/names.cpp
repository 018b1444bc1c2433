// SPDX-License-Identifier: Apache-2.0
#include "filters/rules/names.h"

#include <string_view>

#include "filters/rules/rule.h"
#include "filters/state_models/state_model.h"
#include "filters/state_models/state_name.h"

namespace ifog {

std::string expected_name(const FilterSetting& setting, const std::string& name) {
  std::string list;
  if (setting.key == std::string_view("rule")) {
    for (const RuleEntry& entry : rules()) {
      if (name == entry.name) return "";
      list += (list.empty() ? "" : ", ") + std::string(entry.name);
    }
  } else if (setting.key == std::string_view("state")) {
    if (is_state_model(name)) return "";
    for (const std::string& known : state_model_names()) list += (list.empty() ? "" : ", ") + known;
    list += ", or a sum of them with ' + '";
  } else {
    return "";
  }
  return "one of " + list;
}

}  // namespace ifog
