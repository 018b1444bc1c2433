// SPDX-License-Identifier: Apache-2.0
// The beginning of a denoised rate: until the filter has learned the noise it publishes the compensated rate
// as it is. Taken for the filter's output it would be leaps, and noise, that the filter does not have.
#pragma once

#include <cstddef>

#include "filters/series/series_view.h"

namespace ifog::tools {

// How many rows from the first on are the same bits in both, none in either counted as the same.
[[nodiscard]] std::size_t rows_before_the_filter(const SeriesView& denoised, const SeriesView& compensated);

}  // namespace ifog::tools
