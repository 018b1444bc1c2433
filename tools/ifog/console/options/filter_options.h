// SPDX-License-Identifier: Apache-2.0
// The options that say which filter: the same names in `denoise`, `compare` and `tune`, read into the same
// structure the daemon's configuration is read into.
#pragma once

#include "filters/settings/filter_settings.h"
#include "tools/ifog/console/options/command.h"

namespace ifog::tools {

// An option for each row of filters/settings/filter_table.h. `choice` must outlive the parse. `with_rule`:
// --filter too.
void add_filter_options(const Command& command, FilterChoice& choice, bool with_rule = true);

}  // namespace ifog::tools
