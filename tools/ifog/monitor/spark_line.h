// SPDX-License-Identifier: Apache-2.0
// A line of block characters with eight heights, scaled from the least to the greatest value.
#pragma once

#include <algorithm>
#include <array>
#include <cmath>
#include <cstddef>
#include <limits>
#include <string>

namespace ifog::tools {

struct SparkLine {
  std::string text;
  double span;  // greatest minus least value; NaN without values
};

// The last `width` of `values`; a blank for NaN.
template <typename Values>
SparkLine spark_line(const Values& values, std::size_t width) {
  constexpr std::array<const char*, 8> kHeights{"▁", "▂", "▃", "▄", "▅", "▆", "▇", "█"};
  const std::size_t skip = values.size() > width ? values.size() - width : 0;
  double least = std::numeric_limits<double>::quiet_NaN(), greatest = least;
  for (std::size_t i = skip; i < values.size(); ++i)
    if (std::isfinite(values[i])) {
      least = std::fmin(least, values[i]);
      greatest = std::fmax(greatest, values[i]);
    }
  std::string out;
  for (std::size_t i = skip; i < values.size(); ++i) {
    if (!std::isfinite(values[i])) {
      out += ' ';
      continue;
    }
    const double part = greatest > least ? (values[i] - least) / (greatest - least) : 0.5;
    out += kHeights[std::min<std::size_t>(7, static_cast<std::size_t>(part * 8.0))];
  }
  return {out, greatest - least};
}

}  // namespace ifog::tools
