// SPDX-License-Identifier: Apache-2.0
// Steps of the preparation; PreparedRecords gives their order.
#pragma once

#include "filters/diagnosis/record/owned_records.h"

namespace ifog {

// Replaces stamps that scatter about an even clock by that clock; otherwise two samples would fall on one
// grid step and none on the next. Dwells of a rate table and irregular steps stay unchanged.
OwnedRecords with_even_stamps(OwnedRecords given);

// Of a reference or channel that is slower than the rate and held (a GNSS receiver's, an odometer's, a thermometer's)
// only the readings remain: what is held is not of its time. Of a record with such a reference only the rows of its
// readings remain. Coarse readings that stay the same at irregular times, and columns with missing values, stay
// unchanged.
OwnedRecords with_readings_alone(OwnedRecords given);

// Repairs faults of channels: a thermometer that reads 85 or -127 °C (power-on and bus error of the DS18B20),
// or a glitch. Readings that the daemon's rule (plausible_reading.h) rejects both forwards and backwards in
// time are faults, so a lasting step is none. They are interpolated if shorter than a minute, else missing.
// Channels of few values (switches) and missing values are unchanged.
OwnedRecords repair_channels(OwnedRecords given);

// Shifts the references of all axes by their common delay (cross_delay.h) if it is within ±60 s and certainly not zero: the
// difference would contain the change of the true rate over the delay, which in turns may be the largest part of the
// record. Unchanged: records without a reference or a moving one, with an uneven clock, and tables of dwells.
OwnedRecords align_references(OwnedRecords given);

// Removes single outliers from the rates, as every command does (filters/rest/cleaned_rate.h). Repeated
// values were removed when the capture was read.
OwnedRecords without_leaping_rates(OwnedRecords given);

// Adds the rates of the sensor's other axes as channels, if every record has a moving reference. Without one,
// the common part of two axes is rotation and must not be removed. Other axes are corrected by their own
// misalignment and scale factor; otherwise the square of the angles would remain.
OwnedRecords with_other_axes(OwnedRecords given);

// Sets turned parts to missing and determines the rest, if there is no reference: rotation is not an error.
// Parts that were only shaken stay, as their means are right. Throws std::invalid_argument with one line if a
// record was turned and less than half of it is at rest.
OwnedRecords without_turns(OwnedRecords given);

}  // namespace ifog
