// SPDX-License-Identifier: Apache-2.0
// Quality of the fit of the terms to a spectrum, and the bands that no sum of terms can describe.
#pragma once

#include <vector>

#include "filters/allan/noise/noise_likelihood.h"

namespace ifog {

// Result of a fit without the half-octave bands that differ from the terms by more than kTolerated of the
// deviation. Bands are dropped one by one, most helpful first, at most half of them. Only bands above the
// terms are dropped, since disturbances add power, and the highest ones, which a filter may suppress (not
// counted in the half). The remaining misfit lowers the bins' degrees of freedom.
struct Described {
  NoiseSpectrum spectrum;
  TermVariances terms{};                 // most likely
  double misfit = 0.0;                   // relative, of the deviation, beyond chance
  std::vector<FrequencyRange> left_out;  // cycles per sample, neighbours joined
};
// allowed: terms that may be used.
[[nodiscard]] Described described(NoiseSpectrum spectrum, TermSet allowed = TermSet().set());

}  // namespace ifog
