// SPDX-License-Identifier: Apache-2.0
// When the rows of a capture were measured: what every command makes of its time column.
#pragma once

#include <cstddef>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

// By their stamps, or where those scatter (SampleClock::scatters) by an even clock that has the samples of
// each hole in it.
class RowTimes {
 public:
  // clock: sample_clock(time_s). At least one row.
  RowTimes(const SeriesView& time_s, const SampleClock& clock);

  // Seconds since the first row, of each row in turn.
  double next(double stamp_s);

 private:
  double period_s_, first_s_;
  bool scatters_;
  std::vector<Hole> holes_;
  std::size_t row_ = 0, at_ = 0;
  double even_s_ = 0.0;
};

// Samples a second of a period from time stamps, which carries their rounding: nine digits are more than any
// crystal keeps.
[[nodiscard]] double rounded_rate(double period_s);

}  // namespace ifog
