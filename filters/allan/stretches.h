// SPDX-License-Identifier: Apache-2.0
// What a capture's time column says before any variance is computed: the true sample time, and where samples are
// missing. An Allan variance over a hole would compare averages that do not touch, so holes end a stretch.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "filters/series/series_view.h"

namespace ifog {

// Samples begin … end − 1, evenly spaced and all present.
struct Stretch {
  std::size_t begin = 0, end = 0;
  [[nodiscard]] std::size_t size() const { return end - begin; }
};

struct SampleClock {
  double period_s = 0.0;        // mean of the steps that are no gap
  double worst_jitter_s = 0.0;  // largest distance of such a step from period_s
  std::size_t gaps = 0;         // steps over which samples are missing
  std::size_t missing = 0;      // so many
  double scatter = 0.0;  // deviation of a stamp, in periods, by the steps' median distance from period_s
  // The stamps are off by more than distinguishes steps of an even clock: when a sample was measured its number
  // says better.
  [[nodiscard]] bool scatters() const { return scatter >= 0.1; }
  std::size_t first_gap = 0;  // index of the sample before the first gap; meaningful when gaps > 0
};

// time_s strictly increasing, at least two samples; throws std::invalid_argument otherwise. The median step
// decides what a gap is, so up to half of the steps may be gaps. Time stamps rounded to coarse ticks
// alternate between steps of k and k + 1 ticks; a step counts as a gap only if the stamps stay late after it.
// For stamps that scatter see filters/allan/scattered_stamps.h.
[[nodiscard]] SampleClock sample_clock(const SeriesView& time_s);

struct Hole {
  std::size_t after = 0;  // the last sample before it
  std::size_t lost = 0;
};

// In order.
[[nodiscard]] std::vector<Hole> holes(const SeriesView& time_s, const SampleClock& clock);

// The runs without gap or NaN, in order. time_s may be empty: then only NaNs part them.
[[nodiscard]] std::vector<Stretch> stretches(const SeriesView& time_s, const SeriesView& rate_radps,
                                             const SampleClock& clock);

}  // namespace ifog
