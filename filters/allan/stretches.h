// SPDX-License-Identifier: Apache-2.0
// Sample time and missing samples from a capture's time column. An Allan variance across a gap would compare
// averages that are not adjacent, so a gap ends a stretch; AngleSum fills holes whose effect is negligible.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

namespace ifog {

// Samples begin … end − 1, equidistant and complete.
struct Stretch {
  std::size_t begin = 0, end = 0;
  std::size_t lost = 0;  // samples between the stretch before it and this one; 0: unknown
  [[nodiscard]] std::size_t size() const { return end - begin; }
  [[nodiscard]] std::span<const double> of(std::span<const double> series) const {
    return series.subspan(begin, size());
  }
  bool operator==(const Stretch&) const = default;
};

struct SampleClock {
  double period_s = 0.0;        // mean of the steps without gaps
  double worst_jitter_s = 0.0;  // largest difference between such a step and period_s
  std::size_t gaps = 0;         // steps with missing samples
  std::size_t missing = 0;      // samples
  // standard deviation of the stamps in periods, from the steps' median distance from period_s
  double scatter = 0.0;
  // True if the stamps are too irregular to recognise single steps; then the sample's number gives its time
  // better.
  [[nodiscard]] bool scatters() const { return scatter >= 0.1; }
  std::size_t first_gap = 0;  // index of the sample before the first gap; meaningful when gaps > 0
};

// Throws std::invalid_argument unless time_s is strictly increasing and has two samples or more. An even clock
// with late stamps is assumed where their delay returns. Else the median step defines a gap, so up to half of the
// steps may be gaps. Coarsely rounded stamps alternate between k and k + 1 ticks; so a step is a gap only if later
// stamps stay late. Scattering stamps: filters/allan/scattered_stamps.h.
[[nodiscard]] SampleClock sample_clock(std::span<const double> time_s);

struct Hole {
  std::size_t after = 0;  // the last sample before it
  std::size_t lost = 0;
};

// In order of time.
[[nodiscard]] std::vector<Hole> holes(std::span<const double> time_s, const SampleClock& clock);

// Stretches without gap or NaN, in order. If time_s is empty only NaN divides them.
[[nodiscard]] std::vector<Stretch> stretches(std::span<const double> time_s,
                                             std::span<const double> rate_radps, const SampleClock& clock);

}  // namespace ifog
