// SPDX-License-Identifier: Apache-2.0
// The steps that clean captures before everything else, each with a file of its own. prepared_records.h puts
// them in order.
#pragma once

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// Records whose stamps scatter about the even clock that the samples were taken by, by that clock: on their
// stamps samples would fall on the same step of a grid twice and on the next one not at all. The dwells of a
// rate table, and steps that are uneven in themselves, stay as they are stamped.
OwnedRecords with_even_stamps(OwnedRecords given);

// Faults of a channel's logging: a thermometer that says 85 or -127 °C for some seconds (power-on and bus
// error of the DS18B20), a glitch of the logger. Readings that the daemon's own rule would refuse
// (plausible_reading.h), with the range that the channel usually has, are interpolated between those next to
// them for up to a minute, and missing where they last longer. The daemon sees only what came before; here
// the rule is asked in both directions of time, so that a step to another level stays. Channels of a few
// values stay as they are: a switch may be off for an hour. Missing values stay missing.
OwnedRecords repair_channels(OwnedRecords given);

// The rates without single samples that leap, as every command takes them out (filters/rest/cleaned_rate.h).
// What repeats is missing since the capture was read.
OwnedRecords without_leaping_rates(OwnedRecords given);

// With the rates of the sensor's other axes as channels, where every record has a reference that moves:
// without one, what two axes have in common is rotation, and a correction must not take it away. An axis that
// has a reference of its own comes as the daemon has it, less its own misalignment and scale factor error:
// what this one is fitted on is the true rate's. With the measured ones three misaligned axes would
// be left with the square of their angles.
OwnedRecords with_other_axes(OwnedRecords given);

// A sensor that was turned: without a reference its rotation is no error, and no effect, heading forecast or
// noise figure may be made of it. Turned parts become missing, and what is at rest is known; a record with a
// reference stays as given. What is only shaken stays: its means are right. Throws std::invalid_argument with
// one line when a record was turned and less than half of it is at rest.
OwnedRecords without_turns(OwnedRecords given);

}  // namespace ifog
