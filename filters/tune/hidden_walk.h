// SPDX-License-Identifier: Apache-2.0
// The random walk that a record might hide.
#pragma once

#include <vector>

#include "filters/tune/maximum.h"

namespace ifog {

// Where a record does not tell the level's walk from none, within half a unit of -ln L, its likelihood is
// near flat down to no walk at all, and where the search has stopped on it says nothing. A filter given that
// the level stands still would not follow when it moves, and too quick a walk costs little; so theta then
// gets the quickest walk within half a unit of the best, a bound of one standard deviation. True: it has.
[[nodiscard]] bool bound_hidden_walk(const RecordObjective& objective, std::vector<double>& theta);

}  // namespace ifog
