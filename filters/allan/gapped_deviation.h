// SPDX-License-Identifier: Apache-2.0
// Overlapping Allan deviation of a series with missing samples, for comparing the errors of one record before
// and after a correction: averages of at least half of their samples count.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

// rate_radps: at even steps, NaN missing. m: averaging times in samples, each >= 1. One deviation (rad/s) per
// entry of m, NaN where the series does not hold three such averages. Without a missing sample it is that of
// deviation(); stretches that holes leave apart are compared across them here, not there.
[[nodiscard]] std::vector<double> gapped_deviation(std::span<const double> rate_radps,
                                                   std::span<const std::size_t> m);

}  // namespace ifog
