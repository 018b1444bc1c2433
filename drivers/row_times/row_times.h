// SPDX-License-Identifier: Apache-2.0
// Times at which the rows of a capture were measured, used by every command.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "drivers/row_times/sample_clock.h"

namespace ifog {

// The time stamps themselves, or, if they scatter (SampleClock::scatters), an even clock that counts the
// missing samples of each gap.
class RowTimes {
 public:
  // clock: sample_clock(time_s). Needs at least one row.
  RowTimes(std::span<const double> time_s, const SampleClock& clock);

  // Time of the next row, in seconds since the first row.
  double next(double stamp_s);

 private:
  double period_s_, first_s_;
  bool scatters_;
  std::vector<Hole> holes_;
  std::size_t row_ = 0, at_ = 0;
  double even_s_ = 0.0;
};

// Sample rate in Hz, rounded to nine digits; the period from time stamps carries their rounding.
[[nodiscard]] double rounded_rate(double period_s);

}  // namespace ifog
