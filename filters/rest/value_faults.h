// SPDX-License-Identifier: Apache-2.0
// Faults in the values of a logged rate that come from the logging program. Noise figures of such a record
// describe the logger, not the gyro.
#pragma once

#include <cstddef>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

struct ValueFault {
  std::string name;  // held, coarse, clipped, wrapped, unit; leaps, stuck, interleaved from cleaned_rate.h
  std::string text;
};

// Appends what it finds to `found`. rate: rad/s, NaN where missing; parts: its stretches at rest, without
// NaN. Only the first million samples of each stretch are examined.
//   - held: nine of ten values repeat for the same number of samples, two or more;
//   - coarse: most stretches of 256 samples hold at most two values;
//   - clipped: an extreme value is 1 % of the samples, and thrice as frequent as the next and the average one;
//   - wrapped: 1 % of the steps are most of the range, and the middle of the range is empty, of more than
//   two values: signed counts read as unsigned;
//   - unit: the mean at rest exceeds 5 °/s, the largest bias of a MEMS gyro.
// Sensors that stand in turn, each with a bias of its own, are found by leave_out_placeholders() in cleaned_rate.h:
// motion does not hide them, and every command says so.
void find_value_faults(std::span<const double> rate, std::span<const Stretch> parts, double period_s,
                       std::vector<ValueFault>& found);

}  // namespace ifog
