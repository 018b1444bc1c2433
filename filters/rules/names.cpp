// SPDX-License-Identifier: Apache-2.0
#include "filters/rules/names.h"

#include <algorithm>
#include <string_view>
#include <vector>

#include "drivers/ifog/nearest.h"
#include "filters/rules/rule.h"
#include "filters/state_models/state_model.h"
#include "filters/state_models/state_name.h"

namespace ifog {

std::string expected_name(const FilterSetting& setting, const std::string& name) {
  if (setting.key == std::string_view("rule")) {
    const std::vector<std::string_view> known = rule_names();
    return std::find(known.begin(), known.end(), name) == known.end() ? one_of(name, known) : "";
  }
  if (setting.key == std::string_view("state") && !is_state_model(name)) return expected_state_model(name);
  return "";
}

}  // namespace ifog
