// SPDX-License-Identifier: Apache-2.0
// From a plugin's description and samples to the plain structs of filters/chain.
#pragma once

#include <string>

#include "drivers/ifog/driver.h"
#include "filters/chain/reading.h"

namespace ifog {

// nominal_rate_hz > 0 overrides the plugin's. Throws KeyError: neither says a rate, too many channels.
SensorFacts sensor_facts(const ifog_description& description, double nominal_rate_hz, int outside_channels);

// What a channel may be: what is said of it, and what its unit can be at all.
Limits channel_limits(const std::string& name, const Limits& said);

// The channels that come in frames; the others are left alone.
void read_sample(const ifog_sample& sample, int frame_channels, Reading& out) noexcept;

}  // namespace ifog
