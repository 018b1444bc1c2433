// SPDX-License-Identifier: Apache-2.0
// Faults of logging: a thermometer that says 85 or -127 °C for some seconds (power-on and bus error of the
// DS18B20), a glitch of the logger; and those of the rate.
#pragma once

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// Readings that the daemon's own rule would refuse (plausible_reading.h), with the range that the channel
// usually has, are interpolated between those next to them for up
// to a minute, and missing where they last longer. The daemon sees only what came before; here the
// rule is asked in both directions of time, so that a step to another level stays. Channels of a few values
// are left alone: a switch may be off for an hour. Missing values stay missing.
OwnedRecords repair_channels(OwnedRecords given);

// The rates without single samples that leap, as every command takes them out (filters/rest/cleaned_rate.h). What
// repeats is missing since the capture was read.
OwnedRecords without_leaping_rates(OwnedRecords given);

}  // namespace ifog
