// SPDX-License-Identifier: Apache-2.0
// The gyros of this bench, in units of their white noise.
#pragma once

#include <vector>

#include "tests/bench/notice/slow_noise.h"

namespace ifog::bench {

// Kinds whose Allan deviation reaches 0.664 B, or the least of N and K, after so long.
[[nodiscard]] std::vector<NoiseKind> kinds();
// What no table of noise has: a temperature that leaves something in the rate, from day to night and from
// hour to hour.
[[nodiscard]] std::vector<NoiseKind> wandering_kinds();

// As IEEE Std 952 has it: the floor of the Allan deviation is 0.664 of it. 0: there is no floor.
[[nodiscard]] double bias_instability(const NoiseKind& kind);

}  // namespace ifog::bench
