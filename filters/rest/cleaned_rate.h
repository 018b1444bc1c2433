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
#include "filters/rest/value_faults.h"
#include "filters/series/long_series.h"

namespace ifog {

using TimeOfSample = std::function<double(std::size_t)>;  // s, for the text

// Sets repeated values to NaN; to be called before the search for rest. rate: rad/s, NaN where missing.
// Removed are runs of eight or more equal samples, if nine of ten runs are single samples, and placeholders
// such as -999 (LeapOf::kOneValue, glitches.h).
void leave_out_repeats(LongSeries& rate, const TimeOfSample& time_s, std::vector<ValueFault>& faults);

// Rate in which single outliers of `error` are replaced by the median of their neighbours. nullopt if there
// are none, or too many to be outliers (glitches.h). error: rate minus reference, or the rate; parts: at
// rest.
[[nodiscard]] std::optional<LongSeries> without_leaps(const SeriesView& rate, const SeriesView& error,
                                                      std::span<const Stretch> parts,
                                                      const TimeOfSample& time_s,
                                                      std::vector<ValueFault>& faults);

}  // namespace ifog
