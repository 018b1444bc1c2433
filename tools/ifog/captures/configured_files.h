// SPDX-License-Identifier: Apache-2.0
// The files that a daemon's configuration names.
#pragma once

#include "daemon/config/config.h"

namespace ifog::tools {

// Registers them as inputs of the run (command_files.h): models, files named by drivers' options, and devices
// or channels that are files. Throws WrongUsage as will_read() does.
void will_read_files_of(const Config& config);

}  // namespace ifog::tools
