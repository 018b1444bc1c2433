// SPDX-License-Identifier: Apache-2.0
// Sum of the finite values of a series; long series are read in pieces.
#pragma once

#include <cmath>
#include <cstddef>
#include <span>

#include "filters/series/series_view.h"

namespace ifog {

struct FiniteSum {
  double sum = 0.0;
  double count = 0.0;  // of finite values
};

inline FiniteSum finite_sum(std::span<const double> values) {
  FiniteSum out;
  for_each_piece(values, 0, values.size(), [&](std::span<const double> some, std::size_t) {
    for (const double v : some) {
      if (!std::isfinite(v)) continue;
      out.sum += v;
      out.count += 1.0;
    }
  });
  return out;
}

}  // namespace ifog
