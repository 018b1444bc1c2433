// SPDX-License-Identifier: Apache-2.0
#include "tools/ifog/allan/filter_start.h"

#include <algorithm>
#include <cmath>
#include <span>
#include <vector>

namespace ifog::tools {

std::size_t rows_before_the_filter(const SeriesView& denoised, const SeriesView& compensated) {
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
