// SPDX-License-Identifier: Apache-2.0
// Finds missing samples if time stamps scatter so much that a single step is ambiguous: a late stamp makes a
// step of 1.8 periods, a lost sample between a late and an early stamp one of 1.2. A tracking clock follows
// the stamps and numbers each sample.
#pragma once

#include <cstddef>
#include <functional>
#include <span>

namespace ifog {

// Calls found(i, lost, step_s) in order for each sample i after which samples are lost, with the time step
// there.
//
// Exact while each stamp is off by less than half a period. With larger errors, a gap counts only if most of
// the next stamps confirm it (median, which other gaps nearby do not disturb) and the delay does not return
// later, as that of a stalled host does. period_s: within 0.05 % of the true period.
void holes_of_scattered(std::span<const double> time_s, double period_s,
                        const std::function<void(std::size_t i, std::size_t lost, double step_s)>& found);

}  // namespace ifog
