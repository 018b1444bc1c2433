// SPDX-License-Identifier: Apache-2.0
// Data for a picture of one effect: the error without the other effects against the effect's channel, and the
// fit.
#pragma once

#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"

namespace ifog::report {

struct Traced {
  std::string x_label, y_label;
  std::vector<double> x, y;              // means of the error in bins of equal count; SI of the labels' units
  std::vector<double> curve_x, curve_y;  // the fitted effect
  bool angle = false;                    // y is an angle (rad) instead of a rate (rad/s)
};

// Empty for an effect without a channel or with a constant one.
Traced trace(const std::vector<Record>& records, const Diagnosis& diagnosis, std::size_t effect,
             std::size_t bins = 90);

}  // namespace ifog::report
