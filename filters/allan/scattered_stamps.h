// SPDX-License-Identifier: Apache-2.0
// Which samples are missing where stamps scatter so far that a single step does not say: a late stamp makes a
// step of 1.8 periods, and a lost sample between a late and an early one a step of 1.2. What says is a clock
// that follows the stamps, by which each sample has a number.
#pragma once

#include <cstddef>
#include <functional>

#include "filters/series/series_view.h"

namespace ifog {

// found(i, lost, step_s) for each sample i behind which samples are lost, with the step of time there, in
// order. period_s: within a percent of the true one. Right as long as a stamp is off by less than half a
// period; where a few are off by more, a hole counts as real only if most of the next stamps say so, too.
// Other holes close by are no hindrance: the median of numbers that only ever rise is not moved by where else
// they do.
//
// What it gives back is the mean square of how far stamps are off that clock, in periods.
double holes_of_scattered(const SeriesView& time_s, double period_s,
                          const std::function<void(std::size_t i, std::size_t lost, double step_s)>& found);

}  // namespace ifog
