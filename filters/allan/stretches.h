// SPDX-License-Identifier: Apache-2.0
// Stretches of a record without missing samples. An Allan variance across a gap would compare
// averages that are not adjacent, so a gap ends a stretch; AngleSum fills holes whose effect is negligible.
#pragma once

#include <cstddef>
#include <span>
#include <vector>

#include "drivers/row_times/sample_clock.h"

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

// Stretches without gap or NaN, in order. If time_s is empty only NaN divides them.
[[nodiscard]] std::vector<Stretch> stretches(std::span<const double> time_s,
                                             std::span<const double> rate_radps, const SampleClock& clock);

}  // namespace ifog
