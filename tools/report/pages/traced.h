// SPDX-License-Identifier: Apache-2.0
// The picture that convinces: the error without one effect, against what it was traced to, with the fitted
// effect.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog::report {

struct Traced {
  std::string x_label, y_label;
  std::vector<double> x, y;  // means of the error over bins of equal count; SI of the labels' units
  std::vector<double> curve_x, curve_y;  // the fitted effect
  bool angle = false;                    // y is an angle (rad), not a rate (rad/s)
};

// Empty for an effect without a channel, or when the channel never moves.
Traced trace(const std::vector<Record>& records, const Diagnosis& diagnosis, std::size_t effect,
             std::size_t bins = 90);

}  // namespace ifog::report
