// SPDX-License-Identifier: Apache-2.0
// Figures of a record straight from their definitions: the second method beside the project's own.
#pragma once

#include <cmath>
#include <cstddef>
#include <vector>

namespace ifog {

inline double deviation(const std::vector<double>& x) {
  double mean = 0.0;
  double square = 0.0;
  for (const double v : x) mean += v / static_cast<double>(x.size());
  for (const double v : x) square += (v - mean) * (v - mean);
  return std::sqrt(square / static_cast<double>(x.size()));
}

// Overlapping Allan deviation, straight from its definition.
inline double allan(const std::vector<double>& x, std::size_t m) {
  double square = 0.0;
  double n = 0.0;
  for (std::size_t i = 0; i + 2 * m <= x.size(); ++i) {
    double d = 0.0;
    for (std::size_t k = 0; k < m; ++k) d += (x[i + m + k] - x[i + k]) / static_cast<double>(m);
    square += d * d;
    n += 1.0;
  }
  return std::sqrt(0.5 * square / n);
}

}  // namespace ifog
