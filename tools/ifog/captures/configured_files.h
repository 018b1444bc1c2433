// SPDX-License-Identifier: Apache-2.0
// The files that a daemon's configuration names.
#pragma once

#include "daemon/config/config.h"

namespace ifog::tools {

// Into the table of the run's files as what is read (command_files.h): models, what the drivers' options
// name, files that are a device or a channel. Throws WrongUsage as will_read() does.
void will_read_files_of(const Config& config);

}  // namespace ifog::tools
