// SPDX-License-Identifier: Apache-2.0
// Overlapping Allan deviation of a series with missing samples, to compare errors of one record before and
// after a correction.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

// Deviation (rad/s) for each entry of m, NaN if there are fewer than three averages. An average needs half of
// its samples. Without missing samples the result equals deviation(); unlike there, differences reach across
// gaps. rate_radps: equidistant, NaN where missing; m: averaging times in samples, >= 1.
[[nodiscard]] std::vector<double> gapped_deviation(std::span<const double> rate_radps,
                                                   std::span<const std::size_t> m);

}  // namespace ifog
