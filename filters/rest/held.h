// SPDX-License-Identifier: Apache-2.0
// Stretches in which the value stands exactly still though it moves elsewhere: a logger that repeats its last
// value, a sensor that has not begun. They are no quiet noise, and no yardstick of noise either.
#pragma once

#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

struct HeldApart {
  std::vector<Stretch> held, moving;  // in order; together what was asked about
};

// Held: from 64 samples on, and a four-thousandth of the record, if of the steps elsewhere at least half are
// changes: of chance one in 1e19. A sensor whose steps are coarse against its noise has no held stretches.
[[nodiscard]] HeldApart apart_from_held(const SeriesView& rate_radps, const std::vector<Stretch>& parts);

}  // namespace ifog
