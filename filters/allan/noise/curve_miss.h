// SPDX-License-Identifier: Apache-2.0
// Difference between the fitted noise terms and the measured deviation. The terms are fitted to the spectrum,
// where an effect of temperature or vibration may look like another kind of noise; the curve shows it.
#pragma once

#include <string>
#include <vector>

#include "filters/allan/angle_sum.h"
#include "filters/allan/noise/noise_coefficients.h"

namespace ifog {

// Checks the overlapping Allan deviation at octaves of τ with at least eight degrees of freedom. A difference
// counts beyond 3.5 standard deviations, or beyond 2.75 at two octaves in a row with the same sign. The error
// bar of the strongest term there is widened to reach the curve. Nothing is changed if the spectrum has lines
// or dropped bands, which explain the difference.
void widen_to_curve(const AngleSum& sum, double period_s, NoiseCoefficients& found);

// "fit is 5 % off at 3 s; error bars widened", or "" if it is not.
[[nodiscard]] std::string curve_miss_in_words(const NoiseCoefficients& found);

// One line each: what the terms do not describe (lines, bands, a correlated bias, a departure from the curve).
[[nodiscard]] std::vector<std::string> misfit_in_words(const NoiseCoefficients& found);

}  // namespace ifog
