// SPDX-License-Identifier: Apache-2.0
// Whether the noise of a record at rest is the same all along it: N, B and K of a record that is loud for a
// while are those of no part of it.
//
// Octave by octave the mean magnitudes of the record's wavelet coefficients, over 64 equal times of it, are
// to be those of one noise (Whitcher, Guttorp and Percival, "Multiscale detection and location of multiple
// variance changes in the presence of long memory", Journal of Statistical Computation and Simulation 68,
// 2000). The wavelet is Daubechies' of four taps, which sees neither a level nor a ramp and leaves of white
// noise, flicker and a random walk coefficients that hardly depend on one another. What is looked for is one
// stretch, from any of those times to any other, with more or less noise than the rest; then another one
// next to it.
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
  // Deviation of the noise there over that elsewhere, in the octave where it is most, within 1e-6 and 1e6; 0
  // where the value stands exactly still (filters/rest/held.h).
  double times = 1.0;
  FrequencyRange range_hz;  // the octaves that changed, joined
};

// parts: what is at rest and without holes; time_s: of a sample. In order of time, the three surest at most;
// none where the noise is the same, has changed by less than a quarter, or is too short to tell (some hundred
// samples). False in less than 1 % of records whose noise is the same (tests/bench/allan).
[[nodiscard]] std::vector<NoiseChange> noise_changes(const SeriesView& rate_radps,
                                                     std::span<const Stretch> parts, double period_s,
                                                     const std::function<double(std::size_t)>& time_s);

// "the noise is not the same along the record: 5.1 times the noise in 1606 … 1713 s (below 0.78 Hz); the
// figures are of the whole record, choose a part by --from and --to"; empty where it is the same.
[[nodiscard]] std::string in_words(std::span<const NoiseChange> changes);

}  // namespace ifog
