// SPDX-License-Identifier: Apache-2.0
// R of the white noise of one axis of a record, whatever smooth motion there is.
#pragma once

#include <span>

namespace ifog {

// By the median of third differences, of four measurements that lie as close to each other as a sixteenth of
// all do: rate in rad/s, NaN where missing; steps: of each the time since the one before it in nominal
// samples, empty: 1. Infinite with fewer than 12 of them. Allocates.
[[nodiscard]] double roughness(std::span<const double> rate, std::span<const double> steps = {});

}  // namespace ifog
