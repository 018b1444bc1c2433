// SPDX-License-Identifier: Apache-2.0
// What no sensor shows alone: two that read one source and would take each other's bytes, and channels that
// lead a sensor's published rate back into its own correction.
#pragma once

#include <string>
#include <vector>

#include "daemon/config/config.h"

namespace ifog {

// Complaints, one line each. Looks at what files are (a FIFO, a link to a device), opens none.
std::vector<std::string> shared_sources(const Config& config);
std::vector<std::string> feedback_loops(const Config& config);

}  // namespace ifog
