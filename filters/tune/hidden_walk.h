// SPDX-License-Identifier: Apache-2.0
// Upper limit of a random walk that a record does not show.
#pragma once

#include <vector>

#include "filters/tune/maximum.h"

namespace ifog {

// Returns true if the record does not distinguish the level's walk from none within 0.5 of -ln L. Then theta
// is the fastest walk within 0.5 of the best (one standard deviation). A filter without a walk would not
// follow a moving level, while a walk that is too fast costs little.
[[nodiscard]] bool bound_hidden_walk(const RecordObjective& objective, std::vector<double>& theta);

}  // namespace ifog
