// SPDX-License-Identifier: Apache-2.0
// The gyros of this benchmark, in units of their white noise.
#pragma once

#include <vector>

#include "tests/bench/notice/slow_noise.h"

namespace ifog::bench {

// Kinds by the averaging time at which the Allan deviation reaches 0.664 B, or the minimum of N and K.
[[nodiscard]] std::vector<NoiseKind> kinds();
// A temperature effect that remains in the rate, by day and by hour; no table of noise contains it.
[[nodiscard]] std::vector<NoiseKind> wandering_kinds();

// As in IEEE Std 952: the minimum of the Allan deviation divided by 0.664. 0: no minimum.
[[nodiscard]] double bias_instability(const NoiseKind& kind);

}  // namespace ifog::bench
