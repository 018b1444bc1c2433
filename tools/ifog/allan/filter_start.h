// SPDX-License-Identifier: Apache-2.0
// The beginning of a denoised rate: until the filter has learned the noise it publishes the compensated rate
// as it is. Taken for the filter's output it would be leaps, and noise, that the filter does not have.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <span>
#include <vector>

#include "filters/series/series_view.h"

namespace ifog::tools {

// How many rows from the first on are the same bits in both, none in either counted as the same.
[[nodiscard]] std::size_t rows_before_the_filter(const SeriesView& denoised, const SeriesView& compensated);

inline std::size_t rows_before_the_filter(const SeriesView& denoised, const SeriesView& compensated) {
  const auto same = [](double a, double b) { return a == b || (std::isnan(a) && std::isnan(b)); };
  std::vector<double> room, other_room;
  for (std::size_t at = 0; at < denoised.size(); at += kSeriesPiece) {
    const std::size_t count = std::min(kSeriesPiece, denoised.size() - at);
    const std::span<const double> a = denoised.piece(at, count, room);
    const std::span<const double> b = compensated.piece(at, count, other_room);
    for (std::size_t i = 0; i < count; ++i)
      if (!same(a[i], b[i])) return at + i;
  }
  return denoised.size();
}

}  // namespace ifog::tools
