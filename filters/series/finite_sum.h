// SPDX-License-Identifier: Apache-2.0
// Sum of the finite values of a series.
#pragma once

#include <cmath>
#include <span>

namespace ifog {

struct FiniteSum {
  double sum = 0.0;
  double count = 0.0;  // of finite values
};

inline FiniteSum finite_sum(std::span<const double> values) {
  FiniteSum out;
  for (const double v : values) {
    if (!std::isfinite(v)) continue;
    out.sum += v;
    out.count += 1.0;
  }
  return out;
}

}  // namespace ifog
