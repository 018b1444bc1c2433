// SPDX-License-Identifier: Apache-2.0
// Samples that leap away from their neighbours and back, far beyond all noise: a single one, or some that all
// have one value, as a placeholder has. A fault of the logger or of the line. They are no angle random walk,
// yet one of 1e5 times the noise makes N of a record a thousand times too large.
#pragma once

#include <cstddef>
#include <functional>
#include <span>
#include <string>
#include <vector>

#include "filters/allan/stretches.h"
#include "filters/series/series_view.h"

namespace ifog {

struct Glitches {
  struct Leap {
    std::size_t sample = 0;
    double between = 0.0;  // the middle of the neighbouring values, rad/s
  };
  std::size_t count = 0;
  std::size_t first = 0;  // sample; meaningful when count > 0
  // All of them while they are few, at most one in a thousand samples besides those of one value farthest from zero;
  // empty where there are more, which is how the sensor is.
  std::vector<Leap> few;
  // The largest leap over the standard deviation of the noise, by the median of second differences.
  double most_times = 0.0;
};

// One sample; or, wherever the sensor moved, what a placeholder looks like: two to seven of one value, or any of the
// value farthest from zero where the record has that more than once, as with -9999 now and then.
enum class LeapOf { kOneSample, kOneValue };

// parts: without holes, and for one sample at rest, as a blow is one too. What leaps stands between two that
// differ by less than half of the leap, by more than 30 standard deviations: of Gaussian noise not one in
// 1e190. The deviation is that of the record, or of the hundred samples about it where those are more than
// twice as high: growing noise is no fault of the logger; and half the smallest step of a coarse
// sensor at least.
[[nodiscard]] Glitches find_glitches(const SeriesView& rate_radps, std::span<const Stretch> parts,
                                     LeapOf of = LeapOf::kOneSample);

// "1 sample leaps away and back (at 100.3 s, 1e+05 times the noise); ..." and whether it is dropped;
// empty for none. time_s: of a sample.
[[nodiscard]] std::string in_words(const Glitches& glitches,
                                   const std::function<double(std::size_t)>& time_s);

}  // namespace ifog
