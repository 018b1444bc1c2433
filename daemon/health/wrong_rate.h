// SPDX-License-Identifier: Apache-2.0
// Message about a device that sends at another rate than configured.
#pragma once

#include <algorithm>
#include <cmath>
#include <string>

#include "filters/units/told_time.h"

namespace ifog {

// interval_error: fitted / nominal period - 1, limited by the fit to half … twice the nominal period; beyond,
// the counted rate is used. counted_hz: present samples per second.
inline std::string wrong_rate_in_words(double nominal_hz, double interval_error, double counted_hz) {
  constexpr double kHeld = 1e-6;
  const double fitted_hz = nominal_hz / (1.0 + interval_error);
  double rate_hz = fitted_hz;
  if (interval_error <= -0.5 + kHeld) rate_hz = std::max(fitted_hz, counted_hz);
  if (interval_error >= 1.0 - kHeld && counted_hz > 0.0) rate_hz = std::min(fitted_hz, counted_hz);
  // Intervals in use are 1/nominal, the true ones 1/rate.
  const double off = rate_hz / nominal_hz - 1.0;
  return formatted(
      "samples come at %.4g Hz by their arrival, expected %.4g Hz: intervals, and angles made of a "
      "rate, are %.3g %% too %s",
      rate_hz, nominal_hz, 100.0 * std::abs(off), off < 0.0 ? "small" : "large");
}

}  // namespace ifog
