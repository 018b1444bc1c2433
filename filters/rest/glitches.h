// SPDX-License-Identifier: Apache-2.0
// Outliers far beyond the noise: one sample, or several samples of one value (a placeholder). They are faults
// of the logger or the line. One outlier of 1e5 times the noise makes N of a record a thousand times too
// large.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/stretches.h"

namespace ifog {

struct Glitches {
  struct Leap {
    Stretch samples;
    double value = 0.0;  // instead, rad/s: median of the neighbouring values; NaN for a placeholder
  };
  std::size_t count = 0;
  std::size_t first = 0;  // sample; meaningful when count > 0
  // All outliers if they are few: at most one in 200 samples, not counting placeholders. Empty if
  // there are more, since frequent outliers belong to the sensor.
  std::vector<Leap> few;
  // Largest leap divided by the noise standard deviation.
  double most_times = 0.0;
};

// kOneSample: one sample. kOneValue, also in motion: placeholders, i.e. the value farthest from zero, twice as
// far as any other, if it recurs, or stays for three to seven samples where repeats are rare. At the beginning
// of a stretch, where a sensor may not be ready, it may stay longer.
enum class LeapOf { kOneSample, kOneValue };

// Finds outliers in `parts`, which hold no NaN and, for kOneSample, are at rest, because a shock is one
// sample too. A leap exceeds 30 standard deviations, its two neighbours differ by less than half of it, and
// none of seven samples on either side leaps elsewhere. The deviation is the record's, from second differences;
// the local one (about a hundred samples) if that is more than twice as high; and at least half the sensor's
// smallest step.
[[nodiscard]] Glitches find_glitches(std::span<const double> rate_radps, std::span<const Stretch> parts,
                                     LeapOf of = LeapOf::kOneSample);

// "1 sample leaps away and back (at 100.3 s, 1e+05 times the noise); ..." and whether it is dropped; empty if
// there is none. time_s: time of a sample.
[[nodiscard]] std::string in_words(const Glitches& glitches,
                                   const std::function<double(std::size_t)>& time_s);

}  // namespace ifog
