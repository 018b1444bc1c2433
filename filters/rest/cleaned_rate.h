// SPDX-License-Identifier: Apache-2.0
// Removes faults of the logger or the line from a rate. Every command uses these functions, so all report the
// same faults in the same words: each function appends one line to `faults` per kind of fault.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/rest/glitches.h"
#include "filters/rest/value_faults.h"
#include "filters/series/samples.h"

namespace ifog {

using TimeOfSample = std::function<double(std::size_t)>;  // s, for the text

// Sets placeholders such as -999 (LeapOf::kOneValue, glitches.h) to NaN, for commands that pass the rate on, and tells of
// sensors that stand in turn. rate: rad/s, NaN where missing.
void leave_out_placeholders(Samples& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);

// Also sets runs at the largest value to NaN, where the sensor or its number format is at full scale: no measurement.
void leave_out_full_scale(Samples& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);

// Also sets all runs of equal samples to NaN, where the logger repeats its last value or the sensor has not started: of eight
// or more if nine of ten runs are single samples, else of 64 and 1/4096 of the record if half of the other samples
// differ from the one before. To be called before the search for rest.
void leave_out_repeats(Samples& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);

// Rate in which single outliers of `error` are replaced by the median of their neighbours. nullopt if there
// are none, or too many to be outliers (glitches.h). error: rate minus reference, or the rate; parts: at
// rest. Placeholders become NaN instead.
[[nodiscard]] std::optional<Samples> without_leaps(std::span<const double> rate,
                                                   std::span<const double> error,
                                                   std::span<const Stretch> parts, const TimeOfSample& time_s,
                                                   std::vector<ValueFault>& faults,
                                                   LeapOf of = LeapOf::kOneSample);

}  // namespace ifog
