// SPDX-License-Identifier: Apache-2.0
// Message about a device that sends at another rate than configured.
#pragma once

#include <cmath>
#include <string>

#include "filters/units/told_time.h"

namespace ifog {

// interval_error: Incrementer::interval_error().
inline std::string wrong_rate_in_words(double nominal_hz, double interval_error) {
  const double rate_hz = nominal_hz / (1.0 + interval_error);
  // Intervals in use are 1/nominal, the true ones 1/rate.
  const double off = rate_hz / nominal_hz - 1.0;
  return formatted(
      "samples come at %.4g Hz by their arrival, expected %.4g Hz: intervals, and angles made of a "
      "rate, are %.3g %% too %s",
      rate_hz, nominal_hz, 100.0 * std::abs(off), off < 0.0 ? "small" : "large");
}

}  // namespace ifog
