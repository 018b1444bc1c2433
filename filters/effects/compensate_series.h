// SPDX-License-Identifier: Apache-2.0
// Correction of a whole series, sample by sample as in the daemon.
#pragma once

#include <algorithm>
#include <limits>
#include <span>
#include <vector>

#include "drivers/row_times/sample_clock.h"
#include "filters/effects/compensator.h"

namespace ifog {

// All columns as long as time_s.
struct SeriesToCompensate {
  std::span<const double> time_s;
  std::vector<std::span<const double>> rate_radps;  // by axis of the compensator
  std::vector<std::span<const double>> channels;    // by Compensator::channels(); empty: no values
};

// A step more than half of this longer is a gap. 0 for fewer than two samples.
inline double usual_step(std::span<const double> time_s) {
  return time_s.size() < 2 ? 0.0 : sample_clock(time_s).period_s;
}

// Calls use(sample, output) for every sample in order. The first sample covers as much time as the second.
template <class Use>
void compensate_series(Compensator& compensator, const SeriesToCompensate& series, Use&& use) {
  std::vector<double> now(series.channels.size());
  CompensatorInput in;
  CompensatorOutput out;
  const double usual_s = usual_step(series.time_s);
  for (std::size_t i = 0; i < series.time_s.size(); ++i) {
    const std::size_t end = i == 0 ? 1 : i;
    in.dt_s = end < series.time_s.size() ? series.time_s[end] - series.time_s[end - 1] : 0.0;
    in.missed_s.fill(in.dt_s > 1.5 * usual_s ? in.dt_s - usual_s : 0.0);
    for (std::size_t c = 0; c < now.size(); ++c)
      now[c] = series.channels[c].empty() ? std::numeric_limits<double>::quiet_NaN() : series.channels[c][i];
    in.channels = now;
    for (std::size_t a = 0; a < series.rate_radps.size(); ++a) in.rate_radps[a] = series.rate_radps[a][i];
    compensator.step(in, out);
    use(i, out);
  }
}

}  // namespace ifog
