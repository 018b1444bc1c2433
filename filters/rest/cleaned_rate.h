// SPDX-License-Identifier: Apache-2.0
// A rate without what the logger or the line did to it. Every command takes the same faults out and says so in
// the same words: each function appends a line to `faults` for what it found.
#pragma once

#include <cstddef>
#include <functional>
#include <optional>
#include <span>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/rest/value_faults.h"
#include "filters/series/long_series.h"

namespace ifog {

using TimeOfSample = std::function<double(std::size_t)>;  // s, for the text

// Before it is asked where the sensor rested, values that the rate (rad/s, NaN where missing) repeats become
// missing: a sensor or logger that did nothing, or a placeholder such as -999. That is eight samples or more,
// where nine of ten values stand once; or a value that leaps away and back as placeholders do (glitches.h).
void leave_out_repeats(LongSeries& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);

// For commands that hand the rate on as it came: placeholders alone become missing, by the same rule.
void leave_out_placeholders(LongSeries& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);

// The rate with the middle of their neighbours in place of single samples that leap away and back; nothing where
// there are none, or too many to be no noise. error: the rate less the reference, if any; parts: at rest.
[[nodiscard]] std::optional<LongSeries> without_leaps(const SeriesView& rate, const SeriesView& error,
                                                      std::span<const Stretch> parts,
                                                      const TimeOfSample& time_s,
                                                      std::vector<ValueFault>& faults);

}  // namespace ifog
