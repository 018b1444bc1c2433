// SPDX-License-Identifier: Apache-2.0
// How far the noise terms of a record are from the deviation that was measured of it. The terms are fitted to
// the spectrum, where an effect of the temperature or a vibration may pass for noise of another kind; the
// curve then shows it.
#pragma once

#include "filters/allan/angle_sum.h"
#include "filters/allan/noise/noise_coefficients.h"

namespace ifog {

struct CurveMiss {
  double departure = 0.0;  // relative, of the terms' deviation from the measured one; 0: within chance
  double tau_s = 0.0;      // where it is largest
};

// Looks at the overlapping Allan deviation at every octave of τ where it has eight degrees of freedom or more.
// A departure counts beyond 3.5 standard deviations, or beyond 2.75 at two octaves in a row to the same side.
// The term that is most of the curve there gets an error bar which reaches the curve. Lines and left-out bands
// stand out of the curve by themselves and say so: with them nothing is changed.
CurveMiss widen_to_curve(const AngleSum& sum, double period_s, NoiseCoefficients& found);

}  // namespace ifog
