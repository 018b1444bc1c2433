// SPDX-License-Identifier: Apache-2.0
// The settings whose values are names that other rooms than the table of settings give: rules and state
// models.
#pragma once

#include <string>

#include "filters/settings/filter_table.h"

namespace ifog {

// "" for a name that is one, and for a setting whose value is no such name; else what was expected: "one of
// ckf, …".
[[nodiscard]] std::string expected_name(const FilterSetting& setting, const std::string& name);

}  // namespace ifog
