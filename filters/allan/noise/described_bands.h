// SPDX-License-Identifier: Apache-2.0
// How well the terms describe a spectrum, and which bands of it no sum of them comes near.
#pragma once

#include <vector>

#include "filters/allan/noise/noise_likelihood.h"

namespace ifog {

// Half-octave bands of the bins in use that stand farther from the likeliest terms than kTolerated of the
// deviation are dropped, the one whose absence helps most first and at most half of them. Only those above
// the terms: what disturbs adds power, and terms that a band has less power than are refuted by it. But for
// the highest bands, from which a filter has removed the noise; these are not counted in the half. What
// misfit stays is made part of the uncertainty: it lowers the bins' degrees of freedom.
struct Described {
  NoiseSpectrum spectrum;
  TermVariances terms{};                 // the likeliest
  double misfit = 0.0;                   // relative, of the deviation, beyond chance
  std::vector<FrequencyRange> left_out;  // cycles a sample, neighbours joined
};
// allowed: terms that may be there.
[[nodiscard]] Described described(NoiseSpectrum spectrum, TermSet allowed = TermSet().set());

}  // namespace ifog
