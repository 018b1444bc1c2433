// SPDX-License-Identifier: Apache-2.0
// Detects a change of the noise level within a record at rest. N, B and K of such a record describe no part
// of it.
//
// The mean magnitudes of wavelet coefficients in 64 equal time cells are compared, octave by octave
// (Whitcher, Guttorp and Percival, J. Stat. Comput. Simul. 68, 2000). The Daubechies wavelet of four taps
// ignores level and ramp. Its coefficients of white, flicker and random-walk noise are almost independent.
// The test looks for one stretch of cells with more or less noise than the rest, then for another one next to
// it.
#pragma once

#include <functional>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/noise/noise_spectrum.h"
#include "filters/allan/stretches.h"

namespace ifog {

struct NoiseChange {
  double from_s = 0.0, to_s = 0.0;  // the stretch
  // Ratio of the noise deviation there to that elsewhere, in the octave where it changes most, limited to
  // 1e-6 … 1e6.
  double times = 1.0;
  FrequencyRange range_hz;  // the octaves that changed, joined
};

// Changes of the noise level in order of time, at most the three most significant. Empty if the level changes
// by less than a quarter or the record has only some hundred samples. False alarms: less than 1 % of
// simulated records. parts: at rest and without NaN; time_s: time of a sample.
[[nodiscard]] std::vector<NoiseChange> noise_changes(std::span<const double> rate_radps,
                                                     std::span<const Stretch> parts, double period_s,
                                                     const std::function<double(std::size_t)>& time_s);

// "the noise is not the same along the record: 5.1 times the noise in 1606 … 1713 s (below 0.78 Hz); the
// figures are of the whole record, choose a part by --from and --to"; empty if it does not change.
[[nodiscard]] std::string in_words(std::span<const NoiseChange> changes);

}  // namespace ifog
