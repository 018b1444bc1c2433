// SPDX-License-Identifier: Apache-2.0
// Runs of equal values.
#pragma once

#include <cmath>
#include <cstddef>
#include <limits>
#include <span>

#include "filters/allan/stretches.h"
#include "filters/series/series_view.h"

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
void for_each_run(const SeriesView& series, std::span<const Stretch> parts, Use use) {
  constexpr double kNone = std::numeric_limits<double>::quiet_NaN();
  for (const Stretch& part : parts) {
    Run run{part.begin, 0, kNone, kNone, kNone};
    for_each_piece(series, part.begin, part.end, [&](std::span<const double> values, std::size_t first) {
      for (std::size_t k = 0; k < values.size(); ++k) {
        if (run.length > 0 && values[k] != run.value) {
          run.after = values[k];
          use(run);
          run = {first + k, 0, values[k], run.value, kNone};
        }
        run.value = values[k];
        ++run.length;
      }
    });
    if (run.length > 0) use(run);
  }
}

}  // namespace ifog
