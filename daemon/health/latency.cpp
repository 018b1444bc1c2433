// SPDX-License-Identifier: Apache-2.0
#include "daemon/health/latency.h"

#include <algorithm>
#include <cmath>

namespace ifog {

double LatencyHistogram::percentile_us(double p) const noexcept {
  if (total_ == 0) return 0.0;
  const double wanted = p * static_cast<double>(total_);
  double seen = 0.0;
  for (std::size_t b = 0; b < count_.size(); ++b) {
    seen += count_[b];
    if (seen < wanted) continue;
    const double octave = std::ldexp(1.0, static_cast<int>(b / kPerOctave));
    const double edge = octave * (1.0 + static_cast<double>(b % kPerOctave + 1) / kPerOctave);
    return std::min(edge, static_cast<double>(max_ns_)) * 1e-3;
  }
  return max_us();
}

}  // namespace ifog
