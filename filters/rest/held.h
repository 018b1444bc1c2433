// SPDX-License-Identifier: Apache-2.0
// Stretches where the value does not change at all although it changes elsewhere: the logger repeats its last
// value, or the sensor has not started. They must not enter a noise estimate.
#pragma once

#include <span>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

struct HeldApart {
  std::vector<Stretch> held, moving;  // in order; together all of `parts`
};

// Splits `parts`. Held: runs of equal values from 64 samples and 1/4096 of the record on, if at least half of
// the other steps are changes. So a sensor whose resolution is coarse against its noise has no held
// stretches.
[[nodiscard]] HeldApart apart_from_held(std::span<const double> rate_radps,
                                        const std::vector<Stretch>& parts);

}  // namespace ifog
