// SPDX-License-Identifier: Apache-2.0
#include "filters/allan/row_times.h"

#include <algorithm>
#include <cmath>

namespace ifog {

RowTimes::RowTimes(const SeriesView& time_s, const SampleClock& clock)
    : period_s_(clock.period_s), first_s_(time_s.at(0)), scatters_(clock.scatters()) {
  if (scatters_) holes_ = holes(time_s, clock);
}

double RowTimes::next(double stamp_s) {
  if (!scatters_) return stamp_s - first_s_;
  if (row_ > 0) {
    const bool hole = at_ < holes_.size() && holes_[at_] + 1 == row_;
    at_ += hole ? 1 : 0;
    even_s_ += hole ? period_s_ * std::max(2.0, std::round((stamp_s - last_s_) / period_s_)) : period_s_;
  }
  ++row_;
  last_s_ = stamp_s;
  return even_s_;
}

}  // namespace ifog
