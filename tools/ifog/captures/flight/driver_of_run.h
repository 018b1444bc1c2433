// SPDX-License-Identifier: Apache-2.0
// A driver as the commands make it.
#pragma once

#include <string>
#include <vector>

#include "drivers/host/driver_instance.h"

namespace ifog::tools {

// Its warnings are told, and the files that its settings name are read: no output of the run is one of them
// (command_files.h). folders: that plugins are looked for in; empty: the standard places. Throws as
// DriverInstance does.
[[nodiscard]] DriverInstance driver_of_run(const std::string& name, const DriverSettings& settings,
                                           const std::vector<std::string>& folders = {});

}  // namespace ifog::tools
