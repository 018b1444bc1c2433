// SPDX-License-Identifier: Apache-2.0
// The pictures of a diagnosis, each a <figure> with caption; "" if there is nothing to draw.
#pragma once

#include <cstddef>
#include <string>
#include <vector>

#include "filters/diagnosis/diagnose.h"
#include "tools/report/pages/diagnosis_page.h"

namespace ifog::report {

std::string time_picture(const Diagnosis& d);
std::string spectrum_picture(const Diagnosis& d);
std::string allan_picture(const Diagnosis& d);
// For one effect: the error against its channel, and its part over time.
std::string traced_picture(const PageAxis& axis, std::size_t index);
std::string contribution_picture(const Diagnosis& d, std::size_t index);
std::string heading_picture(const HeadingPrediction& h);

// Data for a picture of one effect: the error without the other effects against the effect's channel, and the
// fit.
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
