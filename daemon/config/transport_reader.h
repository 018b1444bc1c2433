// SPDX-License-Identifier: Apache-2.0
// [sensor.transport]: from where a sensor's bytes or frames come.
#pragma once

#include <toml++/toml.h>
#include <string>

#include "daemon/config/config.h"
#include "daemon/config/reading_context.h"

namespace ifog {

// `where`: the table's key path. Complaints go into the context.
TransportConfig read_transport(const toml::table& table, const std::string& where, ReadingContext& context);

}  // namespace ifog
