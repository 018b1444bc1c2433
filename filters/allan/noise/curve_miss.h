// SPDX-License-Identifier: Apache-2.0
// Difference between the fitted noise terms and the measured deviation. The terms are fitted to the spectrum,
// where an effect of temperature or vibration may look like another kind of noise; the curve shows it.
#pragma once

#include "filters/allan/angle_sum.h"
#include "filters/allan/noise/noise_coefficients.h"

namespace ifog {

// Checks the overlapping Allan deviation at octaves of τ with at least eight degrees of freedom. A difference
// counts beyond 3.5 standard deviations, or beyond 2.75 at two octaves in a row with the same sign. The error
// bar of the strongest term there is widened to reach the curve. Nothing is changed if the spectrum has lines
// or dropped bands, which explain the difference.
void widen_to_curve(const AngleSum& sum, double period_s, NoiseCoefficients& found);

}  // namespace ifog
