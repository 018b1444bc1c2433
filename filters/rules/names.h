// SPDX-License-Identifier: Apache-2.0
// Settings whose values are names of rules or state models.
#pragma once

#include <string>

#include "filters/settings/filter_table.h"

namespace ifog {

// "" if the name is valid or the setting has no such names; else what was expected: "one of ckf, …".
[[nodiscard]] std::string expected_name(const FilterSetting& setting, const std::string& name);

}  // namespace ifog
