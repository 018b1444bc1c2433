// SPDX-License-Identifier: Apache-2.0
// What the values of a logged rate say of the program that logged it: a figure of noise from such a record is
// one of the logger, not of the gyro.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/series/series_view.h"

namespace ifog {

struct ValueFault {
  std::string name;  // held, clipped, wrapped, interleaved, unit, moving; of cleaned_rate.h leaps, stuck
  std::string text;  // one line for people
};

// rate: rad/s, NaN where missing; parts: its stretches at rest, without holes. In each stretch at most the
// first million samples are looked at. Appended to `found`:
//   - held: nine of ten values stand for the same number of samples, two or more;
//   - clipped: the largest or the smallest value is one sample in a hundred, and three times as frequent as
//   the next one;
//   - wrapped: one step in a hundred is most of the range of the values, whose middle is empty: signed counts
//   read as unsigned;
//   - interleaved: around the means of every second, third or fourth sample values scatter by less than half of what all do;
//   - unit: the mean at rest is beyond 5 °/s, the worst bias of a MEMS gyro;
//   - moving: means of 1 s scatter by more than 0.2 °/s, beyond the noise of any gyro.
void find_value_faults(const SeriesView& rate, std::span<const Stretch> parts, double period_s,
                       std::vector<ValueFault>& found);

}  // namespace ifog
