// SPDX-License-Identifier: Apache-2.0
#include "drivers/row_times/row_times.h"

#include <cmath>
#include <span>

namespace ifog {

RowTimes::RowTimes(std::span<const double> time_s, const SampleClock& clock)
    : period_s_(clock.period_s), first_s_(time_s.front()), scatters_(clock.scatters()) {
  if (scatters_) holes_ = holes(time_s, clock);
}

double rounded_rate(double period_s) {
  const double rate = 1.0 / period_s;
  const double unit = std::pow(10.0, std::floor(std::log10(rate)) - 8.0);
  return std::round(rate / unit) * unit;
}

double RowTimes::next(double stamp_s) {
  if (!scatters_) return stamp_s - first_s_;
  if (row_ > 0) {
    const bool hole = at_ < holes_.size() && holes_[at_].after + 1 == row_;
    even_s_ += period_s_ * static_cast<double>(hole ? holes_[at_].lost + 1 : 1);
    at_ += hole ? 1 : 0;
  }
  ++row_;
  return even_s_;
}

}  // namespace ifog
