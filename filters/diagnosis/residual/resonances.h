// SPDX-License-Identifier: Apache-2.0
// Peaks of the spectrum that are too wide, or come and go too much, to be lines: what the mounting or the
// structure does, which is motion and no error of the sensor.
#pragma once

#include <span>
#include <string>
#include <vector>

namespace ifog {

struct Resonance {
  double frequency_hz = 0.0;
  double ratio = 0.0;  // power density over the median of that around it
};

// error: at even steps of period_s, NaN missing. Averaged over pieces, so that white noise and flicker show
// none; strongest first, at most eight. None in a record shorter than sixteen pieces of 1024 samples.
std::vector<Resonance> find_resonances(std::span<const double> error, double period_s);

// One sentence, empty when there are none.
std::string resonances_in_words(const std::vector<Resonance>& found);

}  // namespace ifog
