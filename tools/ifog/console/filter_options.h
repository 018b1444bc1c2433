// SPDX-License-Identifier: Apache-2.0
// The options of the filter: the same names in `denoise`, `compare` and `tune`, with the structure of the
// daemon's configuration.
#pragma once

#include <nlohmann/json.hpp>

#include "filters/settings/filter_settings.h"
#include "tools/ifog/console/command.h"

namespace ifog::tools {

// Adds an option for each row of filters/settings/filter_table.h, and --filter if `with_rule`. `choice` must
// outlive the parse.
void add_filter_options(const Command& command, FilterChoice& choice, bool with_rule = true);

// The settings by the keys of the configuration.
nlohmann::json filter_json(const FilterSettings& settings);

}  // namespace ifog::tools
