// SPDX-License-Identifier: Apache-2.0
// Converts a plugin's description and samples to the structs of filters/chain.
#pragma once

#include <string>

#include "drivers/ifog/driver.h"
#include "filters/chain/reading.h"

namespace ifog {

// nominal_rate_hz > 0 overrides the plugin's. Throws KeyError: no rate is given, or too many channels.
SensorFacts sensor_facts(const ifog_description& description, double nominal_rate_hz, int outside_channels);

// Limits of a channel: configured ones and those of its unit.
Limits channel_limits(const std::string& name, const Limits& said);

// Only the channels in frames; others are unchanged.
void read_sample(const ifog_sample& sample, int frame_channels, Reading& out) noexcept;

}  // namespace ifog
