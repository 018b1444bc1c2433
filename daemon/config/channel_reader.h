// SPDX-License-Identifier: Apache-2.0
// [[sensor.channel]]: an environment channel, and the limits that rates and channels are held to.
#pragma once

#include <toml++/toml.h>
#include <string>

#include "daemon/config/config.h"
#include "daemon/config/reading_context.h"

namespace ifog {

// `where`: the table's key path. Complaints go into the context.
ChannelConfig read_channel(const toml::table& table, const std::string& where, ReadingContext& context);

// minimum, maximum and max_step of values that are within ±most.
Limits read_limits(TableReader& in, double most, const ReadingContext& context);

}  // namespace ifog
