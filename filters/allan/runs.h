// SPDX-License-Identifier: Apache-2.0
// Runs of equal values.
#pragma once

#include <algorithm>
#include <cmath>
#include <cstddef>
#include <limits>
#include <map>
#include <span>

#include "filters/allan/stretches.h"

namespace ifog {

struct Run {
  std::size_t begin = 0, length = 0;
  double value = 0.0;
  double before = 0.0, after = 0.0;  // neighbouring values; NaN at an end of a stretch
};

// How often values repeat: in a log that holds them, a long run is not remarkable.
struct Repeats {
  std::size_t runs = 0, single = 0;

  void add(const Run& run) { ++runs, single += run.length == 1 ? 1 : 0; }
  [[nodiscard]] bool are_rare() const { return 10 * single >= 9 * runs; }
};

// Calls use(run) for each run of each stretch, in order. The stretches hold no NaN.
template <class Use>
void for_each_run(std::span<const double> series, std::span<const Stretch> parts, Use use) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const Stretch& part : parts) {
    Run run{part.begin, 0, kNone, kNone, kNone};
    for (std::size_t i = part.begin; i < part.end; ++i) {
      if (run.length > 0 && series[i] != run.value) {
        run.after = series[i];
        use(run);
        run = {i, 0, series[i], run.value, kNone};
      }
      run.value = series[i];
      ++run.length;
    }
    if (run.length > 0) use(run);
  }
}

// Number of samples for which a logger holds each value of a slower sensor: nine of ten runs have this length. 1 if
// values do not repeat, or there are too few to tell.
inline std::size_t held_samples(std::span<const double> series, std::span<const Stretch> parts) {
  std::map<std::size_t, std::size_t> lengths;
  std::size_t runs = 0;
  for_each_run(series, parts, [&](const Run& run) { ++runs, ++lengths[run.length]; });
  const auto usual = std::ranges::max_element(lengths, {}, [](const auto& each) { return each.second; });
  return runs > 16 && 10 * usual->second >= 9 * runs ? usual->first : 1;
}

}  // namespace ifog
