// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/stretches.h"

#include <cmath>

namespace ifog {

std::vector<Stretch> stretches(std::span<const double> time_s, std::span<const double> rate_radps,
                               const SampleClock& clock) {
  const std::vector<Hole> gaps = holes(time_s, clock);
  std::vector<Stretch> found;
  std::size_t lost = 0;  // since the last value
  auto gap = gaps.begin();
  for (std::size_t i = 0; i < rate_radps.size(); ++i) {
    if (std::isnan(rate_radps[i])) {
      ++lost;
    } else {
      if (found.empty() || lost > 0) found.push_back({i, i, found.empty() ? 0 : lost});
      found.back().end = i + 1;
      lost = 0;
    }
    if (gap != gaps.end() && gap->after == i) lost += gap++->lost;
  }
  return found;
}

}  // namespace ifog
